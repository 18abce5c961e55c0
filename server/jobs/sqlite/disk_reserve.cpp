#include "server/jobs/sqlite/disk_reserve.hpp"

#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace signorini::server {

DiskReserve::DiskReserve(std::filesystem::path file) : file_(std::move(file)) {
  room();
}

void DiskReserve::spend() {
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
  held_ = false;
}

bool DiskReserve::room() {
  if (held_) {
    std::error_code error;
    const std::filesystem::space_info space = std::filesystem::space(file_.parent_path(), error);
    return error || space.available >= static_cast<std::uintmax_t>(bytes);
  }
  const int file = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (file < 0) return false;
  held_ = ::posix_fallocate(file, 0, bytes) == 0;
  ::close(file);
  if (!held_) spend();
  return held_;
}

}  // namespace signorini::server
