// The clock of the machine, ahead by the seconds that the file SHIFTED_CLOCK holds.

#include <cstdio>
#include <cstdlib>
#include <ctime>

#include <dlfcn.h>

extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
  static const auto real = reinterpret_cast<int (*)(clockid_t, timespec*)>(dlsym(RTLD_NEXT, "clock_gettime"));
  const int result = real(clock, time);
  const char* const name = std::getenv("SHIFTED_CLOCK");
  std::FILE* const file = clock == CLOCK_REALTIME && name != nullptr ? std::fopen(name, "r") : nullptr;
  if (file == nullptr) return result;
  long seconds = 0;
  if (std::fscanf(file, "%ld", &seconds) == 1) time->tv_sec += seconds;
  std::fclose(file);
  return result;
}
