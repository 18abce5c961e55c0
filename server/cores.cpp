#include "server/cores.hpp"

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <thread>

#include <unistd.h>

#include <cblas.h>

#include "system/large_products.hpp"

namespace signorini::server {

void use_vector_instructions(char** argv) {
  constexpr const char* variable = "OPENBLAS_CORETYPE";
  const bool unknown_processor = std::string_view(openblas_get_corename()) == "Prescott";
  if (!unknown_processor || std::getenv(variable)) return;
  const bool avx512 = __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
                      __builtin_cpu_supports("avx512vl");
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (!avx2) return;
  setenv(variable, avx512 ? "SkylakeX" : "Haswell", 1);
  execv("/proc/self/exe", argv);  // returns only if it fails: then the solves are slow
}

void share_cores(int solves) {
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  share_large_products(std::max(1, cores / solves));
}

}  // namespace signorini::server
