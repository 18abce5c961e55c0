#include "server/jobs/sqlite/result_bytes.hpp"

#include <algorithm>

#include <sqlite3.h>

namespace signorini::server {

void ResultBytes::Close::operator()(sqlite3_blob* blob) const {
  sqlite3_blob_close(blob);
}

ResultBytes::ResultBytes(const Database& database, const std::string& job) : database_(database) {
  auto row = prepared(database, "SELECT rowid, length(bytes) FROM results WHERE job = ? ORDER BY piece", job);
  while (row.executeStep()) {
    const auto size = static_cast<std::size_t>(row.getColumn(1).getInt64());
    pieces_.push_back({row.getColumn(0).getInt64(), size_, size});
    size_ += size;
  }
}

std::size_t ResultBytes::read(std::size_t offset, std::span<char> room) {
  if (offset >= size_) return 0;
  const Piece& piece = *std::prev(std::ranges::upper_bound(pieces_, offset, {}, &Piece::begin));
  open(piece);
  const std::size_t begin = offset - piece.begin, count = std::min(room.size(), piece.size - begin);
  const int code =
      sqlite3_blob_read(opened_.get(), room.data(), static_cast<int>(count), static_cast<int>(begin));
  if (code != SQLITE_OK) throw SQLite::Exception(database_.getHandle(), code);
  return count;
}

void ResultBytes::open(const Piece& piece) {
  if (opened_ && opened_row_ == piece.row) return;
  sqlite3_blob* blob = nullptr;
  const int code = sqlite3_blob_open(database_.getHandle(), "main", "results", "bytes", piece.row, 0, &blob);
  opened_.reset(blob);
  if (code != SQLITE_OK) throw SQLite::Exception(database_.getHandle(), code);
  opened_row_ = piece.row;
}

}  // namespace signorini::server
