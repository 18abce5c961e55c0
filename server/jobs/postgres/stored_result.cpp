#include "server/jobs/postgres/stored_result.hpp"

#include <algorithm>

namespace signorini::server::postgres {

StoredResult::StoredResult(Connection& connection, std::string job)
    : connection_(connection), job_(std::move(job)) {
  const Rows rows = connection_.run(
      "SELECT results.attempt, piece, length(results.bytes) FROM results JOIN jobs ON id = job "
      "AND jobs.attempt = results.attempt WHERE job = $1 ORDER BY piece",
      Values(job_));
  for (int row = 0; row < rows.size(); ++row) {
    const auto size = static_cast<std::size_t>(rows.integer(row, 2));
    pieces_.push_back({rows.integer(row, 0), rows.integer(row, 1), size_, size});
    size_ += size;
  }
}

std::size_t StoredResult::read(std::size_t offset, std::span<char> room) {
  if (offset >= size_) return 0;
  const Piece& piece = *std::prev(std::ranges::upper_bound(pieces_, offset, {}, &Piece::begin));
  if (held_ != &piece) {
    bytes_ = connection_.run("SELECT bytes FROM results WHERE job = $1 AND attempt = $2 AND piece = $3",
                             Values(job_, piece.attempt, piece.number));
    held_ = &piece;
  }
  const std::string_view bytes = bytes_->view(0, 0);
  return bytes.copy(room.data(), room.size(), offset - piece.begin);
}

}  // namespace signorini::server::postgres
