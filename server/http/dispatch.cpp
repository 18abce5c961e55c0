#include "server/http/dispatch.hpp"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <optional>
#include <string_view>

#include <spdlog/spdlog.h>

#include "server/failure.hpp"
#include "server/http/content.hpp"
#include "server/http/error.hpp"
#include "server/http/media_type.hpp"
#include "server/http/query.hpp"
#include "server/http/sender_fields.hpp"
#include "server/log.hpp"
#include "server/unique_id.hpp"

namespace signorini::server {
namespace {

/// Printable and short, so that it can stand in a header and in a line of the log.
bool is_sane_id(const std::string& id) {
  return !id.empty() && id.size() <= 64 &&
         std::all_of(id.begin(), id.end(), [](char c) { return c > ' ' && c <= '~'; });
}

std::string new_request_id() {
  static UniqueIds ids;
  return ids.next();
}

Response response_of(const HttpError& error) {
  Response response = problem_response(error.status, error.details);
  response.headers = error.headers;
  return response;
}

/// What `make` returns, or the reason why it does not.
template <typename Make>
Response made_by(const Make& make) {
  try {
    Response response = make();
    take_if_short(response);
    return response;
  } catch (const HttpError& error) {
    return response_of(error);
  } catch (...) {
    const Failure failure = describe(std::current_exception());
    Response response = problem_response(failure.status, failure.details);
    if (failure.status == 503) response.headers.emplace_back("Retry-After", "10");
    return response;
  }
}

/// Whether a query parameter would carry a token (RFC 6750, 2.3), however it is written.
bool is_for_token(std::string_view name) {
  std::string plain = percent_decoded(name);
  std::ranges::transform(plain, plain.begin(), [](unsigned char c) { return std::tolower(c); });
  return plain.find("access_token") != std::string::npos;
}

/// A segment of a path or a parameter of a query, in which a token was sent where none belongs.
std::string without_tokens(std::string_view piece) {
  const std::size_t sign = piece.find('=');
  if (sign != std::string_view::npos && is_for_token(piece.substr(0, sign)))
    return std::string(piece.substr(0, sign)) + "=***";
  const std::string plain = percent_decoded(piece);
  return without_secrets(plain) == plain ? std::string(piece) : "***";
}

std::string target_for_log(std::string_view target) {
  std::string text;
  std::string_view separator = "/?";
  while (!target.empty()) {
    const std::size_t end = std::min(target.find_first_of(separator), target.size());
    text += without_tokens(target.substr(0, end));
    if (end < target.size()) text += target[end];
    if (text.ends_with('?')) separator = "&";
    target.remove_prefix(std::min(end + 1, target.size()));
  }
  return text;
}

/// A client chooses these bytes: they must not start a line of their own, or fill the log.
std::string for_log(std::string text) {
  constexpr std::size_t longest = 200;
  text = without_secrets(std::move(text));
  if (text.size() > longest) text.replace(longest, std::string::npos, "...");
  for (char& c : text) {
    if (c < 0x21 || c > 0x7e) c = '?';
  }
  return text;
}

/// What every line of the log says while a request is worked on: its id, and its trace if it has one.
class RequestFields {
 public:
  explicit RequestFields(const Request& request) : request_("request", request.id) {
    if (request.trace) trace_.emplace("trace", request.trace->id);
  }

 private:
  LogField request_;
  std::optional<LogField> trace_;
};

/// Adds the headers that every reply has, writes the line of the log, tells the router's observer.
void finish(const Router& router, const Request& request, Response& response) {
  if (request.accepts_gzip) compress(response);
  router.mark(request, response);
  response.headers.emplace_back("X-Request-Id", request.id);
  if (request.trace) response.headers.emplace_back("traceparent", traceparent(*request.trace));
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - request.begun;
  const LogField method("method", for_log(request.method)),
      path("path", for_log(target_for_log(request.target)));
  const LogField status("status", std::int64_t{response.status});
  std::optional<LogField> job;
  if (!response.job.empty()) job.emplace("job", response.job);
  std::optional<LogField> client;
  if (!request.identity.name.empty()) client.emplace("client", request.identity.name);
  const LogField milliseconds("ms", std::round(time.count() * 1e4) / 10);
  spdlog::info("answered");
  router.replied(request, response, time);
}

}  // namespace

Request request_of(const Connection& connection, const Message& message) {
  Request request;
  request.begun = std::chrono::steady_clock::now();
  request.remote_address = connection.remote_address();
  request.method = message.method;
  request.target = message.target;
  request.host = message.host;
  request.path = message.path;
  request.query = read_query(message.query);
  request.headers = message.headers;
  const std::string id = request.header("X-Request-Id").value_or("");
  request.id = is_sane_id(id) ? id : new_request_id();
  request.trace = read_traceparent(request.header("traceparent").value_or(""));
  request.accepts_gzip = accepts_coding(request.header("Accept-Encoding").value_or(""), "gzip");
  return request;
}

Response dispatch(const Router& router, Request& request) {
  const RequestFields fields(request);
  Response response = made_by([&] { return router.route(request); });
  if (!response.later) finish(router, request, response);
  return response;
}

Response resume(const Router& router, const Request& request, const LaterReply& promised) {
  const RequestFields fields(request);
  Response response = made_by([&] { return promised.make(); });
  finish(router, request, response);
  return response;
}

void leave(const Request& request, const LaterReply& promised) {
  const RequestFields fields(request);
  const SenderFields sender(request);
  const LogField job("job", promised.job);
  spdlog::info("the client left");
  try {
    promised.leave();
  } catch (...) {
    spdlog::warn("{}", describe(std::current_exception()).details.detail);
  }
}

Response refuse(const Router& router, const Request& request, const HttpError& refusal) {
  const RequestFields fields(request);
  Response response = response_of(refusal);
  finish(router, request, response);
  return response;
}

}  // namespace signorini::server
