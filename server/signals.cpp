#include "server/signals.hpp"

#include <atomic>
#include <cerrno>
#include <csignal>

#include <semaphore.h>
#include <unistd.h>

namespace signorini::server {
namespace {

/// Raised by each that arrives.
sem_t arrived;
/// Those that were not taken.
std::atomic<int> stops, hangups;
static_assert(std::atomic<int>::is_always_lock_free, "for a handler");

sigset_t taken_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set, signal);
  return set;
}

void note_signal(int signal) {
  const int before = errno;
  ++(signal == SIGHUP ? hangups : stops);
  sem_post(&arrived);
  errno = before;
}

/// The default would do nothing to the first process of a container.
void end_at_once(int signal) {
  ::_exit(128 + signal);
}

void handle(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(signal, &action, nullptr);
}

bool take_one(std::atomic<int>& count) {
  for (int there = count; there > 0;)
    if (count.compare_exchange_weak(there, there - 1)) return true;
  return false;
}

}  // namespace

// A handler, for blocking them is not enough: OpenBLAS starts its threads before main().
StopSignals::StopSignals() {
  sem_init(&arrived, 0, 0);
  stops = hangups = 0;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) handle(signal, note_signal);
  // A file that may not grow is an error of the write, as on a full disk; so is a log whose reader has left.
  for (const int signal : {SIGXFSZ, SIGPIPE}) handle(signal, SIG_IGN);
  const sigset_t set = taken_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

void StopSignals::wait(const std::function<void()>& on_hangup) const {
  const sigset_t set = taken_signals();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
  while (!take_one(stops)) {
    if (take_one(hangups)) on_hangup();
    while (sem_wait(&arrived) != 0) continue;
  }
}

bool StopSignals::take() const {
  return take_one(stops);
}

void StopSignals::leave() const {
  for (const int signal : {SIGINT, SIGTERM}) handle(signal, end_at_once);
}

void StopSignals::raise() {
  ::kill(::getpid(), SIGTERM);
}

}  // namespace signorini::server
