#include "server/http/content.hpp"

#include <algorithm>
#include <cctype>
#include <optional>

#include "server/http/error.hpp"

namespace signorini::server {
namespace {

/// A list of solves, as long as it is without a word.
constexpr std::size_t longest_short_body = std::size_t{256} * 1024;

/// A compressed body becomes so many bytes, and so many times as long as it was sent: text becomes ten times
/// as long, numbers hardly five, and five kilobytes of zeros megabytes that take half a second to be read.
constexpr std::size_t unpacked_of_any = std::size_t{64} * 1024, most_times_packed = 100;

/// A shorter body fits into one packet as it is.
constexpr std::size_t shortest_compressed_body = 1024;

bool write_compressed(const BodyWriter& write, const PieceSink& sink,
                      api::Effort effort = api::Effort::least) {
  api::Gzip gzip(sink, effort);
  return write([&](std::string_view piece) { return gzip.put(piece); }) && gzip.finish();
}

/// By its names in any case; nothing if it is not known.
std::optional<api::Coding> coding_of(std::string name) {
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  if (name == "gzip" || name == "x-gzip") return api::Coding::gzip;
  if (name == "deflate") return api::Coding::zlib;
  return std::nullopt;
}

HttpError unknown_coding() {
  return {415,
          {"unsupported-media-type", "Unsupported media type",
           "A body may be sent plain or with `Content-Encoding: gzip` or `deflate`."},
          {{"Accept-Encoding", "gzip, deflate"}}};
}

/// The one that a body has; nothing if it is plain. Throws HttpError 415.
std::optional<api::Coding> known(const std::vector<std::string>& codings) {
  if (codings.empty() || (codings.size() == 1 && codings.front() == "identity")) return std::nullopt;
  const std::optional<api::Coding> coding = coding_of(codings.front());
  if (codings.size() > 1 || !coding) throw unknown_coding();
  return coding;
}

HttpError unpacks_to_too_much() {
  return {413,
          {"body-too-large", "Body too large",
           "The body becomes more than " + std::to_string(most_times_packed) +
               " times as long when it is decoded: send it without Content-Encoding."}};
}

HttpError broken_body() {
  return {
      400,
      {"broken-body", "Broken body", "The body is not what Content-Encoding says, or ends before its end."}};
}

}  // namespace

std::string compressed(std::string_view text, api::Effort effort) {
  std::string bytes;
  const auto append = [&](std::string_view piece) {
    bytes += piece;
    return true;
  };
  write_compressed([&](const PieceSink& sink) { return sink(text); }, append, effort);
  return bytes;
}

void take_if_short(Response& response) {
  if (!response.write_body) return;
  std::string body;
  const bool is_short = response.write_body([&](std::string_view piece) {
    if (body.size() + piece.size() > longest_short_body) return false;
    body += piece;
    return true;
  });
  if (!is_short) return;
  response.body = std::move(body);
  response.write_body = nullptr;
}

void compress(Response& response) {
  if (response.write_body) {
    response.write_body = [write = std::move(response.write_body)](const PieceSink& sink) {
      return write_compressed(write, sink);
    };
  } else if (response.compressed) {
    response.body = *response.compressed;
  } else if (response.body.size() >= shortest_compressed_body) {
    response.body = compressed(response.body);
  } else {
    return;
  }
  response.headers.emplace_back("Content-Encoding", "gzip");
}

void require_known(const std::vector<std::string>& codings) {
  known(codings);
}

std::string decoded(std::string body, const std::vector<std::string>& codings, std::size_t max_bytes) {
  if (body.size() > max_bytes) throw body_too_large(max_bytes);
  const std::optional<api::Coding> coding = known(codings);
  if (!coding) return body;
  const std::size_t longest = std::min(max_bytes, unpacked_of_any + most_times_packed * body.size());
  std::string text;
  switch (api::inflate(body, *coding, longest, text)) {
    case api::Inflation::whole:
      return text;
    case api::Inflation::too_long:
      throw longest < max_bytes ? unpacks_to_too_much() : body_too_large(max_bytes);
    case api::Inflation::broken:
      break;
  }
  throw broken_body();
}

}  // namespace signorini::server
