#pragma once

#include <filesystem>

namespace signorini::server {

/// The directory in which one service keeps its jobs, made if it is missing. It is locked while the object
/// lives; the lock ends with the process, however that ends.
class DataDir {
 public:
  /// Throws CannotOpenStore if the directory cannot be made or written, or if another service has it.
  explicit DataDir(std::filesystem::path path);
  ~DataDir();

  DataDir(const DataDir&) = delete;
  DataDir& operator=(const DataDir&) = delete;

  std::filesystem::path database() const { return path_ / "jobs.sqlite"; }
  std::filesystem::path reserve() const { return path_ / "reserve"; }

 private:
  std::filesystem::path path_;
  int lock_ = -1;
};

}  // namespace signorini::server
