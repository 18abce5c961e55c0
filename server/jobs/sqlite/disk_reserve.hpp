#pragma once

#include <filesystem>

namespace signorini::server {

/// A file that holds room on the disk which is needed to free more when the disk is full: even a DELETE
/// writes first. Not safe to be used by several threads at once.
class DiskReserve {
 public:
  /// For the log of a transaction that deletes a result of any size, and what is moved to shrink the file.
  static constexpr int bytes = 4 << 20;

  explicit DiskReserve(std::filesystem::path file);

  /// Gives the room to whoever writes next.
  void spend();

  /// Whether the room is held, after a try to take it again, and as much is free beside it; false when the
  /// disk is full.
  bool room();

 private:
  const std::filesystem::path file_;
  bool held_ = false;
};

}  // namespace signorini::server
