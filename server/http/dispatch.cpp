#include "server/http/dispatch.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>

#include <spdlog/spdlog.h>

#include "server/failure.hpp"
#include "server/http/content.hpp"
#include "server/http/error.hpp"
#include "server/log.hpp"

namespace signorini::server {
namespace {

Response answer(const Router& router, Request& request) {
  try {
    Response response = router.route(request);
    take_if_short(response);
    return response;
  } catch (const HttpError& error) {
    Response response = problem_response(error.status, error.details);
    response.headers = error.headers;
    return response;
  } catch (...) {
    const Failure failure = describe(std::current_exception());
    Response response = problem_response(failure.status, failure.details);
    if (failure.status == 503) response.headers.emplace_back("Retry-After", "10");
    return response;
  }
}

/// A client chooses these bytes: they must not start a line of their own, fill the log, or tell a token that was
/// sent where none belongs (RFC 6750, 2.3).
std::string for_log(std::string text) {
  constexpr std::size_t longest = 200;
  constexpr std::string_view token = "access_token=";
  for (std::size_t at = 0; (at = text.find(token, at)) != std::string::npos;) {
    at += token.size();
    text.replace(at, std::min(text.find('&', at), text.size()) - at, "***");
  }
  if (text.size() > longest) text.replace(longest, std::string::npos, "...");
  for (char& c : text) {
    if (c < 0x21 || c > 0x7e) c = '?';
  }
  return text;
}

}  // namespace

Response dispatch(const Router& router, Request& request) {
  const RequestFields fields(request);
  const auto begin = std::chrono::steady_clock::now();
  Response response = answer(router, request);
  if (request.accepts_gzip) compress(response);
  router.mark(request, response);
  finish_reply(router, request, response, std::chrono::steady_clock::now() - begin);
  return response;
}

RequestFields::RequestFields(const Request& request) : request_("request", request.id) {
  if (request.trace) trace_.emplace("trace", request.trace->id);
}

void finish_reply(const Router& router, const Request& request, Response& response,
                  std::chrono::duration<double> time) {
  response.headers.emplace_back("X-Request-Id", request.id);
  if (request.trace) response.headers.emplace_back("traceparent", traceparent(*request.trace));
  const LogField method("method", for_log(request.method)), path("path", for_log(request.target));
  const LogField status("status", std::int64_t{response.status});
  std::optional<LogField> job;
  if (!response.job.empty()) job.emplace("job", response.job);
  std::optional<LogField> client;
  if (!request.identity.name.empty()) client.emplace("client", request.identity.name);
  const LogField milliseconds("ms", std::round(time.count() * 1e4) / 10);
  spdlog::info("answered");
  router.replied(request, response, time);
}

}  // namespace signorini::server
