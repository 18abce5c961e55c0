#include <filesystem>
#include <fstream>
#include <sstream>

#include <sys/resource.h>
#include <unistd.h>

#include "server/metrics/families.hpp"

namespace signorini::server {
namespace {

/// The fields of /proc/self/stat that are asked for; proc(5).
struct ProcessStat {
  double cpu_seconds = 0;
  double threads = 0;
  double start_seconds = 0;  ///< since the machine was started
  double virtual_bytes = 0;
  double resident_bytes = 0;
};

ProcessStat read_stat() {
  std::ifstream file("/proc/self/stat");
  // The name of the program may hold blanks and brackets; the third field follows the last bracket.
  std::string text{std::istreambuf_iterator<char>(file), {}};
  std::istringstream words(text.substr(text.rfind(')') + 1));
  std::vector<std::string> values{"pid", "name"};
  for (std::string value; words >> value;) values.push_back(value);
  const auto number = [&](std::size_t field) { return std::stod(values.at(field - 1)); };
  const auto ticks = static_cast<double>(sysconf(_SC_CLK_TCK));
  const auto page = static_cast<double>(sysconf(_SC_PAGESIZE));
  return {(number(14) + number(15)) / ticks, number(20), number(22) / ticks, number(23), number(24) * page};
}

/// When the machine was started, in seconds since 1970.
double boot_time() {
  std::ifstream file("/proc/stat");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("btime ")) return std::stod(line.substr(6));
  return 0;
}

double open_descriptors() {
  const auto entries = std::filesystem::directory_iterator("/proc/self/fd");
  const auto count = std::distance(begin(entries), end(entries));
  return static_cast<double>(count - 1);  // without that of the directory itself
}

double most_descriptors() {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  return static_cast<double>(limit.rlim_cur);
}

}  // namespace

std::vector<prometheus::MetricFamily> process_families() {
  const ProcessStat stat = read_stat();
  return {
      counter("process_cpu_seconds_total", "Processor time, seconds.", {{stat.cpu_seconds}}),
      gauge("process_start_time_seconds", "When the process was started, seconds since 1970.",
            {{boot_time() + stat.start_seconds}}),
      gauge("process_resident_memory_bytes", "Memory that is in use.", {{stat.resident_bytes}}),
      gauge("process_virtual_memory_bytes", "Memory that is reserved.", {{stat.virtual_bytes}}),
      gauge("process_threads", "Threads.", {{stat.threads}}),
      gauge("process_open_fds", "File descriptors that are open.", {{open_descriptors()}}),
      gauge("process_max_fds", "File descriptors that may be open.", {{most_descriptors()}}),
  };
}

}  // namespace signorini::server
