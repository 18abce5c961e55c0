#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include <spdlog/sinks/base_sink.h>

namespace signorini::server {

/// Lines to standard error that never wait for its reader. spdlog's own sinks do: a full pipe holds every
/// thread that logs, and their asynchronous form holds the end of the process, whatever its overflow policy.
/// Up to a megabyte is kept until the reader goes on; what is beyond it is counted, and a line says how many
/// were lost.
class StandardError : public spdlog::sinks::base_sink<std::mutex> {
 public:
  StandardError();
  ~StandardError() override;

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override;
  void flush_() override { send(); }

 private:
  void send();
  std::size_t write_some();

  int descriptor_ = 2;
  bool is_socket_ = false;
  bool may_block_ = false;  ///< its writes must be asked for before
  std::string unsent_;
  std::uint64_t lost_ = 0;
};

}  // namespace signorini::server
