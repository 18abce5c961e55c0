#include "server/check_command.hpp"
#include "server/config.hpp"
#include "server/cores.hpp"
#include "server/daemon.hpp"
#include "server/health_command.hpp"
#include "server/inf_sup_command.hpp"
#include "server/log.hpp"
#include "server/solve_command.hpp"
#include "server/study_command.hpp"

int main(int argc, char** argv) {
  using namespace signorini::server;
  use_vector_instructions(argv);
  const CommandLine line = read_command_line(argc, argv);
  if (line.exit_code) return *line.exit_code;
  start_log(line.config.log_level, line.config.log_format);
  if (line.config.health) return run_health(line.config.daemon);
  if (line.config.check) return run_check(*line.config.check);
  if (line.config.study) return run_study_command(*line.config.study);
  if (line.config.inf_sup) return run_inf_sup(*line.config.inf_sup);
  return line.config.solve ? run_solve(*line.config.solve) : run_daemon(line.config.daemon);
}
