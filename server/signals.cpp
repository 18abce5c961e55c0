#include "server/signals.hpp"

#include <cerrno>
#include <csignal>

#include <semaphore.h>
#include <unistd.h>

namespace signorini::server {
namespace {

/// Those that have arrived and were not waited for.
sem_t arrived;

sigset_t stop_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

void note_arrival(int) {
  const int before = errno;
  sem_post(&arrived);
  errno = before;
}

void handle(void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

// A handler, for blocking them is not enough: OpenBLAS starts its threads before main().
StopSignals::StopSignals() {
  sem_init(&arrived, 0, 0);
  handle(note_arrival);
  const sigset_t set = stop_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

void StopSignals::wait() const {
  const sigset_t set = stop_signals();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
  while (sem_wait(&arrived) != 0) continue;
}

bool StopSignals::take() const {
  return sem_trywait(&arrived) == 0;
}

void StopSignals::leave() const {
  handle(SIG_DFL);
}

void StopSignals::raise() {
  ::kill(::getpid(), SIGTERM);
}

}  // namespace signorini::server
