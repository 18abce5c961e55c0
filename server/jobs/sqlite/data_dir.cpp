#include "server/jobs/sqlite/data_dir.hpp"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "server/jobs/store.hpp"

namespace signorini::server {
namespace {

CannotOpenStore cannot_use(const std::filesystem::path& path, const std::string& why) {
  return CannotOpenStore("cannot keep solves in " + path.string() + ": " + why + " (--data-dir)");
}

void make_directory(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw cannot_use(path, error.message());
}

}  // namespace

DataDir::DataDir(std::filesystem::path path) : path_(std::move(path)) {
  make_directory(path_);
  lock_ = ::open((path_ / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (lock_ < 0) throw cannot_use(path_, std::generic_category().message(errno));
  if (::flock(lock_, LOCK_EX | LOCK_NB) == 0) return;
  const int reason = errno;
  ::close(lock_);
  throw cannot_use(path_, reason == EWOULDBLOCK
                              ? "another service runs on it; end that one or take another directory"
                              : std::generic_category().message(reason));
}

DataDir::~DataDir() {
  ::close(lock_);
}

}  // namespace signorini::server
