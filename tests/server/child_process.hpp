#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "temporary_directory.hpp"

namespace signorini::server {

/// `signorinid` as a process of its own, with its streams in files. Killed at the end if it still runs. A
/// launcher is a command that runs another one, such as `env NAME=value`.
class ChildProcess {
 public:
  explicit ChildProcess(const std::vector<std::string>& arguments, const std::string& standard_input = {},
                        const std::vector<std::string>& launcher = {});
  ~ChildProcess();

  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t id() const { return pid_; }
  void signal(int number) const;
  /// The exit code, if it ends by itself in time.
  std::optional<int> wait(std::chrono::seconds time);

  std::string standard_output() const;
  std::string standard_error() const;

 private:
  TemporaryDirectory directory_;
  pid_t pid_ = -1;
  std::optional<int> exit_code_;
};

/// The daemon on a free port.
class Daemon {
 public:
  explicit Daemon(std::vector<std::string> flags = {}, const std::vector<std::string>& launcher = {});

  int port() const { return port_; }
  ChildProcess& process() { return process_; }

 private:
  ChildProcess process_;
  int port_ = 0;
};

}  // namespace signorini::server
