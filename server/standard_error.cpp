#include "server/standard_error.hpp"

#include <algorithm>
#include <climits>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

namespace signorini::server {
namespace {

constexpr std::size_t most_unsent = std::size_t{1} << 20;
constexpr int patience_at_end_ms = 500;

bool can_write(int descriptor, int patience_ms) {
  pollfd entry{descriptor, POLLOUT, 0};
  return ::poll(&entry, 1, patience_ms) == 1 && (entry.revents & POLLOUT) != 0;
}

}  // namespace

// O_NONBLOCK belongs to the open file, which other programs share: ours is opened anew where that is
// possible.
StandardError::StandardError() {
  struct stat status {};
  if (::fstat(STDERR_FILENO, &status) != 0) return;
  is_socket_ = S_ISSOCK(status.st_mode);
  if (!S_ISFIFO(status.st_mode) && !S_ISCHR(status.st_mode)) return;
  const int own = ::open("/proc/self/fd/2", O_WRONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  may_block_ = own < 0;
  if (own >= 0) descriptor_ = own;
}

StandardError::~StandardError() {
  while (!unsent_.empty() && can_write(descriptor_, patience_at_end_ms)) {
    const std::size_t before = unsent_.size();
    send();
    if (unsent_.size() == before) break;
  }
  if (descriptor_ != STDERR_FILENO) ::close(descriptor_);
}

void StandardError::sink_it_(const spdlog::details::log_msg& message) {
  send();
  if (lost_ > 0 && unsent_.empty())
    unsent_ = std::to_string(std::exchange(lost_, 0)) + " lines of the log were lost, for nobody read it\n";
  if (unsent_.size() > most_unsent) {
    ++lost_;
    return;
  }
  spdlog::memory_buf_t line;
  formatter_->format(message, line);
  unsent_.append(line.data(), line.size());
  send();
}

void StandardError::send() {
  std::size_t sent = 0;
  do {
    sent = unsent_.empty() ? 0 : write_some();
    unsent_.erase(0, sent);
  } while (sent > 0);
}

/// 0 if nothing is taken for now.
std::size_t StandardError::write_some() {
  // That much a pipe takes at once if it takes anything.
  const std::size_t count = may_block_ ? std::min<std::size_t>(unsent_.size(), PIPE_BUF) : unsent_.size();
  if (may_block_ && !can_write(descriptor_, 0)) return 0;
  const ssize_t written = is_socket_ ? ::send(descriptor_, unsent_.data(), count, MSG_DONTWAIT | MSG_NOSIGNAL)
                                     : ::write(descriptor_, unsent_.data(), count);
  return written > 0 ? static_cast<std::size_t>(written) : 0;
}

}  // namespace signorini::server
