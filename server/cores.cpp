#include "server/cores.hpp"

#include <cstdlib>
#include <string_view>

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cblas.h>

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

int cores() {
  cpu_set_t own;
  return sched_getaffinity(0, sizeof own, &own) == 0 ? CPU_COUNT(&own) : 1;
}

void give_way_to_answers() {
  // On Linux that is of a thread, not of the process.
  setpriority(PRIO_PROCESS, 0, 10);
}

void use_one_thread_of_blas() {
  openblas_set_num_threads(1);
}

}  // namespace signorini::server
