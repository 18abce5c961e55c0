#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "api/document/cbor_document.hpp"

namespace {

using nlohmann::json;

/// Numbers are read as doubles, whatever they were written as. Below -2^63 nlohmann's integers overflow.
bool mean_the_same(const json& a, const json& b) {
  if (a.is_number() && b.is_number()) return a.get<double>() == b.get<double>() || a.get<double>() <= -0x1p63;
  if (a.type() != b.type() || a.size() != b.size()) return false;
  if (!a.is_structured()) return a == b;
  for (auto own = a.begin(), other = b.begin(); own != a.end(); ++own, ++other)
    if ((a.is_object() && own.key() != other.key()) || !mean_the_same(*own, *other)) return false;
  return true;
}

}  // namespace

/// Whatever bytes come as CBOR, they are refused, or become a text within its limit; and where nlohmann reads
/// the same bytes (it knows no typed arrays) and the text is JSON, both mean the same.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace signorini::api;
  constexpr std::size_t longest = 1 << 14;
  try {
    const std::optional<std::string> text =
        json_of_cbor({reinterpret_cast<const char*>(data), size}, longest);
    if (!text) return 0;
    if (text->size() > longest) std::abort();
    const json read = json::parse(*text, nullptr, false);
    const json meant = json::from_cbor(data, data + size, true, false);
    if (!read.is_discarded() && !meant.is_discarded() && !mean_the_same(read, meant)) std::abort();
  } catch (const MalformedCbor&) {
  }
  return 0;
}
