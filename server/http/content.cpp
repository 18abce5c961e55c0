#include "server/http/content.hpp"

#include "api/gzip.hpp"

namespace signorini::server {
namespace {

constexpr std::size_t longest_short_body = std::size_t{64} * 1024;

/// A shorter body fits into one packet as it is.
constexpr std::size_t shortest_compressed_body = 1024;

bool write_compressed(const BodyWriter& write, const PieceSink& sink) {
  api::Gzip gzip(sink);
  return write([&](std::string_view piece) { return gzip.put(piece); }) && gzip.finish();
}

std::string compressed(const std::string& body) {
  std::string text;
  const auto append = [&](std::string_view piece) {
    text += piece;
    return true;
  };
  write_compressed([&](const PieceSink& sink) { return sink(body); }, append);
  return text;
}

}  // namespace

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
  } else if (response.body.size() >= shortest_compressed_body) {
    response.body = compressed(response.body);
  } else {
    return;
  }
  response.headers.emplace_back("Content-Encoding", "gzip");
}

}  // namespace signorini::server
