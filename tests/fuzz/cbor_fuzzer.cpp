#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "api/cbor_document.hpp"

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
    const auto read = nlohmann::json::parse(*text, nullptr, false);
    const auto meant = nlohmann::json::from_cbor(data, data + size, true, false);
    if (!read.is_discarded() && !meant.is_discarded() && read != meant) std::abort();
  } catch (const MalformedCbor&) {
  }
  return 0;
}
