#include "server/http/framing.hpp"

#include <strings.h>
#include <charconv>

namespace signorini::server {
namespace {

bool read_length(const std::string& text, std::uint64_t& length) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), length);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

Framing framing_of(const httplib::Headers& headers) {
  const std::size_t lengths = headers.count("Content-Length");
  const std::size_t codings = headers.count("Transfer-Encoding");
  if (lengths + codings == 0) return {};
  if (lengths + codings > 1) return {Framing::Kind::ambiguous};
  if (codings == 1) {
    const bool chunked = strcasecmp(headers.find("Transfer-Encoding")->second.c_str(), "chunked") == 0;
    return {chunked ? Framing::Kind::chunked : Framing::Kind::ambiguous};
  }
  Framing sized{Framing::Kind::sized};
  if (!read_length(headers.find("Content-Length")->second, sized.length)) return {Framing::Kind::ambiguous};
  return sized;
}

}  // namespace signorini::server
