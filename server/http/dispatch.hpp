#pragma once

#include <chrono>
#include <optional>

#include "server/http/router.hpp"
#include "server/log.hpp"

namespace signorini::server {

/// Answers a request: routes it, turns whatever is thrown into problem+json, writes the line of the log.
/// Never throws.
Response dispatch(const Router& router, Request& request);

/// What every line of the log says while a request is worked on: its id, and its trace if it has one.
class RequestFields {
 public:
  explicit RequestFields(const Request& request);

 private:
  LogField request_;
  std::optional<LogField> trace_;
};

/// Adds the headers that every reply has, writes the line of the log, tells the router's observer.
void finish_reply(const Router& router, const Request& request, Response& response,
                  std::chrono::duration<double> time);

}  // namespace signorini::server
