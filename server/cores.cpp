#include "server/cores.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
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

namespace {

/// Cores that the time of the control group is worth; without a limit it says `max` or -1.
double cores_of_group() {
  double time = 0, period = 0;
  if (std::ifstream("/sys/fs/cgroup/cpu.max") >> time >> period && time > 0) return time / period;
  if (std::ifstream("/sys/fs/cgroup/cpu/cpu.cfs_quota_us") >> time && time > 0 &&
      std::ifstream("/sys/fs/cgroup/cpu/cpu.cfs_period_us") >> period)
    return time / period;
  return std::numeric_limits<double>::infinity();
}

}  // namespace

int cores() {
  cpu_set_t own;
  const double all = sched_getaffinity(0, sizeof own, &own) == 0 ? CPU_COUNT(&own) : 1;
  return static_cast<int>(std::max(1., std::min(all, std::ceil(cores_of_group()))));
}

void give_way_to_answers() {
  // On Linux that is of a thread, not of the process.
  setpriority(PRIO_PROCESS, 0, 10);
}

void use_one_thread_of_blas() {
  openblas_set_num_threads(1);
}

}  // namespace signorini::server
