#include "server/check_command.hpp"

#include <iostream>

#include "server/exit_code.hpp"
#include "server/jobs/repair.hpp"
#include "server/jobs/store.hpp"

namespace signorini::server {

int run_check(const CheckConfig& config) {
  try {
    if (!std::filesystem::exists(std::filesystem::path(config.directory) / "jobs.sqlite"))
      throw CannotOpenStore("there are no jobs in " + config.directory);
    const DataDir directory(config.directory);
    const Findings findings = repair(directory, Depth::all);
    for (const std::string& damage : findings.damage) std::cout << damage << '\n';
    if (findings.damage.empty()) std::cout << "all is as it was written\n";
    return findings.damage.empty() ? exit_done : exit_failed;
  } catch (const CannotOpenStore& error) {
    std::cerr << error.what() << std::endl;
    return exit_bad_input;
  }
}

}  // namespace signorini::server
