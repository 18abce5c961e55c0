#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/jobs/sqlite/database.hpp"

struct sqlite3_blob;

namespace signorini::server {

/// The stored bytes of a result, of which only what is asked for is read. The database must outlive it, and
/// stay as it is: by a transaction.
class ResultBytes {
 public:
  /// Throws SQLite::Exception.
  ResultBytes(const Database& database, const std::string& job);

  /// How many there are; 0 if there is no result.
  std::size_t size() const { return size_; }

  /// Reads from a place on as much as there is room for, or as is left. Throws SQLite::Exception.
  std::size_t read(std::size_t offset, std::span<char> room);

 private:
  /// A row of the table.
  struct Piece {
    std::int64_t row;
    std::size_t begin, size;
  };
  struct Close {
    void operator()(sqlite3_blob* blob) const;
  };

  void open(const Piece& piece);

  const Database& database_;
  std::vector<Piece> pieces_;
  std::size_t size_ = 0;
  std::unique_ptr<sqlite3_blob, Close> opened_;
  std::int64_t opened_row_ = 0;
};

}  // namespace signorini::server
