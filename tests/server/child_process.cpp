#include "child_process.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace signorini::server {
namespace {

using Clock = std::chrono::steady_clock;

std::string content_of(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// On a free port and, unless the flags say otherwise, with its jobs in memory.
std::vector<std::string> daemon_flags(std::vector<std::string> flags) {
  flags.insert(flags.end(), {"--port", "0"});
  const auto has = [&](const char* flag) {
    return std::find(flags.begin(), flags.end(), flag) != flags.end();
  };
  if (!has("--data-dir") && !has("--database")) flags.insert(flags.end(), {"--data-dir", ":memory:"});
  return flags;
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& arguments, const std::string& standard_input,
                           const std::vector<std::string>& launcher) {
  std::ofstream(directory_.path() + "/in", std::ios::binary) << standard_input;
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, 0, (directory_.path() + "/in").c_str(), O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, 1, (directory_.path() + "/out").c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_addopen(&files, 2, (directory_.path() + "/err").c_str(), O_WRONLY | O_CREAT, 0600);
  std::vector<std::string> words = launcher;
  words.push_back(SIGNORINID);
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  if (posix_spawnp(&pid_, argv[0], &files, nullptr, argv.data(), environ) != 0) {
    ADD_FAILURE() << "cannot start " << words.front();
    exit_code_ = -1;
  }
  posix_spawn_file_actions_destroy(&files);
}

ChildProcess::~ChildProcess() {
  if (!exit_code_) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
}

void ChildProcess::signal(int number) const {
  ::kill(pid_, number);
}

std::optional<int> ChildProcess::wait(std::chrono::seconds time) {
  const auto until = Clock::now() + time;
  while (!exit_code_ && Clock::now() < until) {
    int status = 0;
    if (::waitpid(pid_, &status, WNOHANG) == pid_) {
      exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  return exit_code_;
}

std::string ChildProcess::standard_output() const {
  return content_of(directory_.path() + "/out");
}

std::string ChildProcess::standard_error() const {
  return content_of(directory_.path() + "/err");
}

Daemon::Daemon(std::vector<std::string> flags, const std::vector<std::string>& launcher)
    : process_(daemon_flags(std::move(flags)), {}, launcher) {
  const std::string announcement = "listening on http://127.0.0.1:";
  for (int i = 0; i < 1000 && port_ == 0; ++i) {
    const std::string log = process_.standard_error();
    const std::size_t found = log.find(announcement);
    const bool whole_line = found != std::string::npos && log.find('\n', found) != std::string::npos;
    if (whole_line) port_ = std::atoi(log.c_str() + found + announcement.size());
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  if (port_ == 0) ADD_FAILURE() << "the daemon did not start: " << process_.standard_error();
}

}  // namespace signorini::server
