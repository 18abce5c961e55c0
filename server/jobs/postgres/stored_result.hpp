#pragma once

#include <span>
#include <string>
#include <vector>

#include "server/jobs/postgres/connection.hpp"

namespace signorini::server::postgres {

/// The stored bytes of a result, of which one piece is held at a time. The connection must outlive it, and
/// the tables stay as they are: by a transaction.
class StoredResult {
 public:
  /// Of the last attempt of the job.
  StoredResult(Connection& connection, std::string job);

  /// How many there are; 0 if there is no result.
  std::size_t size() const { return size_; }

  /// Reads from a place on as much as there is room for, or as is left.
  std::size_t read(std::size_t offset, std::span<char> room);

 private:
  struct Piece {
    std::int64_t attempt, number;
    std::size_t begin, size;
  };

  Connection& connection_;
  const std::string job_;
  std::vector<Piece> pieces_;
  std::size_t size_ = 0;
  const Piece* held_ = nullptr;
  std::optional<Rows> bytes_;  ///< of the piece that is held
};

}  // namespace signorini::server::postgres
