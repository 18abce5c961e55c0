#include "server/local_solve.hpp"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include "server/cores.hpp"
#include "server/exit_code.hpp"
#include "server/failure.hpp"
#include "server/idle_cores.hpp"
#include "server/jobs/kept_operators.hpp"
#include "server/machine_memory.hpp"
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
Ending solved(const api::Request& request, LocalObserver& observer, Series* series) {
  KeptOperators not_kept(0);
  IdleCores idle(cores());
  Ending ending = ending_of(solve_request(request, observer, not_kept, idle));
  if (series == nullptr) return ending;
  if (!request.problem.mesh.adaptive) series->add_entry(0, *ending.solution);
  series->finish();
  return ending;
}

void report(const ProblemDetails& details, std::optional<int> status = std::nullopt) {
  std::cerr << (reports_to_terminal() ? to_text(details) : to_json(details, status)) << std::endl;
}

std::string read_all(std::istream& stream) {
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Complains if that cannot be.
bool write_to_stdout(const std::function<bool(const api::Sink& sink)>& write) {
  const bool is_taken = write([](std::string_view piece) {
    return std::fwrite(piece.data(), 1, piece.size(), stdout) == piece.size();
  });
  const bool written = std::fflush(stdout) == 0 && is_taken;
  if (!written)
    report({"unwritable-output", "The output cannot be written",
            std::string("Standard output takes no more: ") + std::strerror(errno) + "."});
  return written;
}

/// A fault of the data that only the real mesh shows is bad input too.
int exit_code_of(const Failure& failure) {
  return failure.details.kind == "invalid-problem" ? exit_bad_input : exit_failed;
}

/// What the work returns, or the exit code of what it throws, which goes to standard error.
int reported(const std::function<int()>& work) {
  try {
    return work();
  } catch (const BadInput&) {
    throw;
  } catch (...) {
    const Failure failure = describe(std::current_exception());
    report(failure.details, status_of(failure.details));
    return exit_code_of(failure);
  }
}

}  // namespace

std::string read_input(const std::string& file) {
  if (file == "-") return read_all(std::cin);
  std::ifstream stream(file, std::ios::binary);
  std::error_code unknown;
  const bool is_readable = stream.is_open() && !std::filesystem::is_directory(file, unknown);
  std::string text = is_readable ? read_all(stream) : "";
  if (!is_readable || stream.bad())
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
  return reported([&] {
    const Ending ending = [&] {
      LocalObserver observer(estimate(request.problem).triangles, series);
      return solved(request, observer, series);
    }();
    if (ending.error) report(*ending.error);
    const bool written = write_to_stdout([&](const api::Sink& sink) { return write(ending, sink); });
    return written && ending.status == JobStatus::succeeded ? exit_done : exit_failed;
  });
}

int find_and_write(std::int64_t triangles, const std::function<void(Observer&)>& find,
                   const std::function<bool(const api::Sink& sink)>& write) {
  return reported([&] {
    {
      LocalObserver observer(triangles, nullptr);
      find(observer);
    }
    return write_to_stdout(write) ? exit_done : exit_failed;
  });
}

int run_locally(const std::function<int()>& command) {
  use_one_thread_of_blas();
  keep_freed_memory();
  try {
    return command();
  } catch (const BadInput& bad) {
    report(bad.details, bad.status);
    return exit_bad_input;
  }
}

}  // namespace signorini::server
