#include <cstddef>
#include <cstdint>
#include <string>

#include "api/problem/expression.hpp"

/// Whatever text stands for an expression, it is refused with a fault, or it can be evaluated, if only to a
/// value that is refused.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace signorini;
  const std::string text(reinterpret_cast<const char*>(data), size);
  for (const api::Variables variables : {api::Variables::interior, api::Variables::boundary}) {
    try {
      const Field field = api::compile_expression(text, "/load/body", variables);
      for (const double x : {0.0, -1.5, 1e300}) field(Point(x, 1), Vector(0, 1));
    } catch (const InvalidProblem&) {
    }
  }
  return 0;
}
