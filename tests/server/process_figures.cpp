#include "process_figures.hpp"

#include <filesystem>
#include <fstream>
#include <string>

namespace signorini::server {
namespace {

std::string directory_of(pid_t process) {
  return "/proc/" + std::to_string(process);
}

}  // namespace

ProcessFigures figures_of(pid_t process) {
  ProcessFigures figures;
  std::ifstream lines(directory_of(process) + "/status");
  for (std::string name; lines >> name; lines.ignore(1000, '\n')) {
    if (name == "VmRSS:" && lines >> figures.memory) figures.memory *= 1024;
    if (name == "VmHWM:" && lines >> figures.peak_memory) figures.peak_memory *= 1024;
    if (name == "Threads:") lines >> figures.threads;
  }
  for ([[maybe_unused]] const auto& entry :
       std::filesystem::directory_iterator(directory_of(process) + "/fd")) {
    ++figures.descriptors;
  }
  return figures;
}

void forget_peak(pid_t process) {
  std::ofstream(directory_of(process) + "/clear_refs") << "5";
}

}  // namespace signorini::server
