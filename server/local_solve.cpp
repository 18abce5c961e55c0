#include "server/local_solve.hpp"

#include <csignal>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>

#include "server/cores.hpp"
#include "server/exit_code.hpp"
#include "server/failure.hpp"
#include "server/jobs/kept_operators.hpp"
#include "server/terminal.hpp"

namespace signorini::server {
namespace {

volatile std::sig_atomic_t stop_asked = 0;

void ask_to_stop(int) {
  stop_asked = 1;
}

/// Shows how far the solve is, adds its levels and entries to a series if there is one, and ends it on
/// Ctrl-C.
class LocalObserver : public Observer {
 public:
  LocalObserver(std::int64_t triangles, Series* series) : progress_(triangles), series_(series) {
    std::signal(SIGINT, ask_to_stop);
    std::signal(SIGTERM, ask_to_stop);
  }

  void entered(Phase phase) override { progress_.entered(phase); }
  void iterated(const Iteration& iteration) override { progress_.iterated(iteration); }
  void refined(const Level& level, const Solution& solution) override {
    progress_.refined(level);
    if (series_ != nullptr) series_->add_level(level, solution);
  }
  bool sees_entries() const override { return series_ != nullptr; }
  void entry(std::size_t number, const Solution& solution) override {
    series_->add_entry(number + 1, solution);
  }
  void swept(std::size_t done, std::size_t count) override { progress_.done("entry", done, count); }
  void studied(std::size_t done, std::size_t count) override { progress_.done("run", done, count); }
  bool keep_going() override {
    progress_.show_now_and_then();
    return stop_asked == 0;
  }

 private:
  TerminalProgress progress_;
  Series* const series_;
};

/// Solves the problem and completes its series.
Ending solved(const api::Request& request, Series* series) {
  LocalObserver observer(estimate(request.problem).triangles, series);
  KeptOperators not_kept(0);
  Ending ending = ending_of(solve_request(request, observer, not_kept));
  if (series == nullptr) return ending;
  if (!request.problem.mesh.adaptive) series->add_entry(0, *ending.solution);
  series->finish();
  return ending;
}

void report(const ProblemDetails& details, std::optional<int> status = std::nullopt) {
  std::cerr << to_json(details, status) << std::endl;
}

std::string read_all(std::istream& stream) {
  return {std::istreambuf_iterator<char>(stream), {}};
}

bool write_to_stdout(const Ending& ending, const WriteEnding& write) {
  const bool written = write(ending, [](std::string_view piece) {
    return std::fwrite(piece.data(), 1, piece.size(), stdout) == piece.size();
  });
  return std::fflush(stdout) == 0 && written;
}

/// A fault of the data that only the real mesh shows is bad input too.
int exit_code_of(const Failure& failure) {
  return failure.details.kind == "invalid-problem" ? exit_bad_input : exit_failed;
}

}  // namespace

std::string read_input(const std::string& file) {
  if (file == "-") return read_all(std::cin);
  std::ifstream stream(file, std::ios::binary);
  std::string text = read_all(stream);
  if (!stream.is_open() || stream.bad())
    throw BadInput{{"unreadable-file", "The file cannot be read", "Cannot read " + file + "."}};
  return text;
}

api::Request parse_input(const std::string& text) {
  try {
    return api::parse_request(text);
  } catch (...) {
    const Failure failure = describe(std::current_exception());
    throw BadInput{failure.details, failure.status};
  }
}

int solve_and_write(const api::Request& request, const WriteEnding& write, Series* series) {
  try {
    const Ending ending = solved(request, series);
    if (ending.error) report(*ending.error);
    const bool written = write_to_stdout(ending, write);
    return written && ending.status == JobStatus::succeeded ? exit_done : exit_failed;
  } catch (const BadInput&) {
    throw;
  } catch (...) {
    const Failure failure = describe(std::current_exception());
    report(failure.details, status_of(failure.details));
    return exit_code_of(failure);
  }
}

int run_locally(const std::function<int()>& command) {
  share_cores(1);
  try {
    return command();
  } catch (const BadInput& bad) {
    report(bad.details, bad.status);
    return exit_bad_input;
  }
}

}  // namespace signorini::server
