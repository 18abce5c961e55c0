#include <cstddef>
#include <cstdint>
#include <string_view>

#include "api/document/json_document.hpp"
#include "api/problem/problem_json.hpp"

/// Whatever bytes a client sends, the parser of problems takes them or refuses them with a fault.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    signorini::api::parse_request({reinterpret_cast<const char*>(data), size});
  } catch (const signorini::api::MalformedJson&) {
  } catch (const signorini::InvalidProblem&) {
  }
  return 0;
}
