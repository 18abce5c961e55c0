#include "server/http/exchange.hpp"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "server/http/error.hpp"
#include "server/http/framing.hpp"
#include "server/http/media_type.hpp"
#include "server/unique_id.hpp"

namespace signorini::server {
namespace {

constexpr const char* request_id_header = "X-Request-Id";
constexpr const char* accept_encoding_header = "X-Accept-Encoding";

/// Printable and short, so that it can stand in a header and in a line of the log.
bool is_sane_id(const std::string& id) {
  return !id.empty() && id.size() <= 64 &&
         std::all_of(id.begin(), id.end(), [](char c) { return c > ' ' && c <= '~'; });
}

std::string new_request_id() {
  static UniqueIds ids;
  return ids.next();
}

/// The raw path: the paths of this service hold only characters that nobody has a reason to encode.
std::string path_of(const std::string& target) {
  return target.substr(0, target.find('?'));
}

Request translate(const httplib::Request& from) {
  Request request;
  request.id =
      from.has_header(request_id_header) ? from.get_header_value(request_id_header) : new_request_id();
  request.remote_address = from.remote_addr;
  request.method = from.method;
  request.target = from.target;
  request.path = path_of(from.target);
  request.query.insert(from.params.begin(), from.params.end());
  request.headers.insert(from.headers.begin(), from.headers.end());
  request.trace = read_traceparent(request.header("traceparent").value_or(""));
  request.accepts_gzip = accepts_coding(request.header(accept_encoding_header).value_or(""), "gzip");
  return request;
}

bool is_decodable(const std::string& content_encoding) {
  return content_encoding.empty() || content_encoding == "identity" || content_encoding == "gzip" ||
         content_encoding == "deflate";
}

HttpError unsupported(const std::string& detail) {
  return {415, {"unsupported-media-type", "Unsupported media type", detail}};
}

HttpError broken_body() {
  return {
      400,
      {"broken-body", "Broken body",
       "The body ended early, came too slowly, or is not what Transfer-Encoding and Content-Encoding say."}};
}

/// The body of one request, read at most once.
class Body {
 public:
  Body(const httplib::Request& from, const httplib::ContentReader* reader)
      : from_(from), reader_(reader), framing_(framing_of(from.headers)) {}

  bool is_ambiguous() const { return framing_.kind == Framing::Kind::ambiguous; }

  /// Whether bytes of it may still stand in the connection, which then cannot take another request. After
  /// chunks they always may: httplib takes a malformed chunk for the end.
  bool may_be_pending() const {
    if (framing_.kind == Framing::Kind::sized) return framing_.length > 0 && !complete_;
    return framing_.kind != Framing::Kind::none;
  }

  std::string read(std::size_t max_bytes) {
    if (framing_.kind == Framing::Kind::none || reader_ == nullptr) return {};
    if (framing_.length > max_bytes) throw body_too_large(max_bytes);
    // httplib would call a multipart parser that is not there.
    if (from_.is_multipart_form_data()) throw unsupported("Multipart bodies are not taken.");
    if (!is_decodable(from_.get_header_value("Content-Encoding"))) {
      throw unsupported("A body may be sent plain or with `Content-Encoding: gzip` or `deflate`.");
    }
    return read_counting(max_bytes);
  }

 private:
  std::string read_counting(std::size_t max_bytes) {
    std::string body;
    bool too_large = false;
    complete_ = (*reader_)([&](const char* data, std::size_t size) {
      too_large = size > max_bytes - body.size();
      if (!too_large) body.append(data, size);
      return !too_large;
    });
    if (too_large) throw body_too_large(max_bytes);
    if (!complete_) throw broken_body();
    return body;
  }

  const httplib::Request& from_;
  const httplib::ContentReader* reader_;
  const Framing framing_;
  bool complete_ = false;
};

/// A body that is written while it is sent. No exception may pass: httplib would let it end the process.
httplib::ContentProviderWithoutLength provider(BodyWriter write_body, std::string request_id) {
  return [write_body = std::move(write_body), request_id = std::move(request_id)](std::size_t,
                                                                                  httplib::DataSink& sink) {
    const LogField request("request", request_id);
    try {
      const bool complete = write_body(
          [&](std::string_view piece) { return piece.empty() || sink.write(piece.data(), piece.size()); });
      if (complete) sink.done();
      if (!complete) spdlog::info("the client left before the reply ended");
      return complete;
    } catch (const std::exception& error) {
      spdlog::error("the reply broke off: {}", error.what());
      return false;
    }
  };
}

/// Ends the reply with its head: the body is sent by the one who takes the connection, until it closes it.
bool head_only(std::size_t, httplib::DataSink& sink) {
  sink.done();
  return true;
}

void transfer(Response response, const Request& request, const httplib::Request& from,
              httplib::Response& to) {
  to.status = response.status;
  for (const auto& [name, value] : response.headers) to.set_header(name, value);
  if (response.take_connection) {
    to.set_content_provider(response.content_type, head_only);
    to.set_header("Connection", "close");
  } else if (response.write_body && from.version == "HTTP/1.0") {
    to.set_content_provider(response.content_type, provider(std::move(response.write_body), request.id));
  } else if (response.write_body) {
    to.set_chunked_content_provider(response.content_type,
                                    provider(std::move(response.write_body), request.id));
  } else if (!response.content_type.empty()) {
    to.set_content(response.body, response.content_type);
  }
}

/// A reply that comes before any route is asked.
Response refuse(const Router& router, const Request& request, int status, const ProblemDetails& details) {
  const RequestFields fields(request);
  Response response = problem_response(status, details);
  finish_reply(router, request, response, {});
  return response;
}

}  // namespace

void sanitize(httplib::Request& request) {
  const std::string id = request.get_header_value(request_id_header);
  request.headers.erase(request_id_header);
  request.set_header(request_id_header, is_sane_id(id) ? id : new_request_id());

  request.ranges.clear();
  request.headers.erase("Range");

  request.headers.erase(accept_encoding_header);
  const auto [first, last] = request.headers.equal_range("Accept-Encoding");
  for (auto coding = first; coding != last; ++coding)
    request.headers.emplace(accept_encoding_header, coding->second);
  request.headers.erase("Accept-Encoding");
}

void exchange(const Router& router, Connection& connection, const httplib::Request& from,
              httplib::Response& to, const httplib::ContentReader* reader) {
  Request request = translate(from);
  Body body(from, reader);
  request.read_body = [&](std::size_t max_bytes) {
    std::string text = body.read(max_bytes);
    connection.stream().body_is_over();
    return text;
  };
  request.client_left = [&connection] { return connection.client_left(); };
  Response response =
      body.is_ambiguous()
          ? refuse(router, request, 400,
                   {"ambiguous-length", "Ambiguous length",
                    "Send either one Content-Length with a number or `Transfer-Encoding: chunked`."})
          : dispatch(router, request);
  if (response.take_connection) connection.give_away_to(response.take_connection);
  transfer(std::move(response), request, from, to);
  if (body.may_be_pending()) to.set_header("Connection", "close");
}

void explain_refusal(const Router& router, const httplib::Request& from, httplib::Response& to) {
  const bool explained = to.has_header(request_id_header);
  if (explained) return;
  const Request request = translate(from);
  transfer(refuse(router, request, to.status, details_of_status(to.status)), request, from, to);
  to.set_header("Connection", "close");
}

void correct_headers(const httplib::Request& from, httplib::Response& to) {
  const bool close = to.has_header("Connection");
  to.headers.erase("Connection");
  to.headers.erase("Keep-Alive");
  if (close) to.set_header("Connection", "close");
  if (from.method == "HEAD") to.headers.erase("Accept-Ranges");
  if (to.status == 204) to.headers.erase("Content-Length");
}

}  // namespace signorini::server
