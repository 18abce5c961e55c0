#include "server/terminal.hpp"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <sys/ioctl.h>
#include <unistd.h>

namespace signorini::server {
namespace {

using namespace std::chrono_literals;

constexpr auto between_looks = 100ms;

/// One that can take its last line back.
bool is_terminal(int descriptor) {
  const char* const kind = std::getenv("TERM");
  return ::isatty(descriptor) == 1 && kind != nullptr && std::strcmp(kind, "dumb") != 0;
}

std::size_t columns() {
  winsize size{};
  constexpr std::size_t usual = 80;
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : usual;
}

void put(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

const std::string take_line_away = "\r\x1b[K";

template <typename... Values>
std::string printed(const char* format, Values... values) {
  std::array<char, 160> text;
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

}  // namespace

bool writes_to_terminal() {
  return ::isatty(STDOUT_FILENO) == 1;
}

bool reports_to_terminal() {
  return is_terminal(STDERR_FILENO);
}

TerminalProgress::TerminalProgress(std::int64_t triangles)
    : shows_(reports_to_terminal()), triangles_(triangles) {}

TerminalProgress::~TerminalProgress() {
  if (shows_) put(take_line_away);
}

void TerminalProgress::entered(Phase phase) {
  phase_ = phase;
  show_now_and_then();
}

void TerminalProgress::iterated(const Iteration& iteration) {
  iteration_ = iteration.number;
  show_now_and_then();
}

void TerminalProgress::refined(const Level& level) {
  triangles_ = level.triangles;
  if (!shows_) return;
  put(take_line_away + printed("level %-3d %9d triangles  bound %-10.4g %6.3g %%  %.1f s\n", level.number,
                               level.triangles, level.bound, 100 * level.relative, seconds()));
}

void TerminalProgress::done(const char* what, std::size_t done, std::size_t count) {
  parts_ = printed("  %s %zu of %zu", what, done, count);
  show_now_and_then();
}

void TerminalProgress::show_now_and_then() {
  if (!shows_ || Clock::now() - shown_ < between_looks) return;
  shown_ = Clock::now();
  // A line that is longer would not be taken away whole.
  put(take_line_away + line().substr(0, columns() - 1));
}

std::string TerminalProgress::line() const {
  return printed("%-9s  %lld triangles  iteration %d  %.1f s", name(phase_),
                 static_cast<long long>(triangles_), iteration_, seconds()) +
         parts_;
}

double TerminalProgress::seconds() const {
  return std::chrono::duration<double>(Clock::now() - begun_).count();
}

}  // namespace signorini::server
