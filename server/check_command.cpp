#include "server/check_command.hpp"

#include <filesystem>
#include <iostream>

#include "server/exit_code.hpp"
#include "server/jobs/sqlite/repair.hpp"
#include "server/jobs/store.hpp"

namespace signorini::server {
namespace {

/// As a service leaves it that is killed before its first write.
bool holds_nothing(const std::filesystem::path& database) {
  const std::filesystem::path log = database.string() + "-wal";
  return std::filesystem::is_empty(database) &&
         (!std::filesystem::exists(log) || std::filesystem::is_empty(log));
}

}  // namespace

int run_check(const CheckConfig& config) {
  try {
    if (!std::filesystem::exists(std::filesystem::path(config.directory) / "jobs.sqlite"))
      throw CannotOpenStore("there are no jobs in " + config.directory);
    const DataDir directory(config.directory);
    if (holds_nothing(directory.database())) {
      std::cout << "jobs.sqlite is empty: no solve was kept in it yet\n";
      return exit_done;
    }
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
