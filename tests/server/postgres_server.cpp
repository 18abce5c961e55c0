#include "postgres_server.hpp"

#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <pwd.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/jobs/postgres/connection.hpp"

namespace signorini::server {
namespace {

using namespace std::chrono_literals;

/// Starts a program of PostgreSQL, which does not run as root.
pid_t spawn(const std::vector<std::string>& command, const std::string& log) {
  std::vector<std::string> words{"setpriv", "--pdeathsig", "INT"};
  if (::getuid() == 0) words.insert(words.end(), {"--reuid=postgres", "--regid=postgres", "--clear-groups"});
  words.insert(words.end(), command.begin(), command.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, 1, log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  posix_spawn_file_actions_adddup2(&files, 1, 2);
  pid_t pid = -1;
  const int code = posix_spawnp(&pid, argv[0], &files, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (code != 0) throw std::runtime_error("cannot start " + command.front());
  return pid;
}

const std::string programs = POSTGRES_PROGRAMS;

/// In memory where there is room for it: a disk that others write to may keep a new database waiting for
/// seconds.
std::string place() {
  constexpr std::uintmax_t enough = 1'000'000'000;
  std::error_code none;
  const auto space = std::filesystem::space("/dev/shm", none);
  return !none && space.available > enough ? "/dev/shm/postgres-XXXXXX" : "/tmp/postgres-XXXXXX";
}

}  // namespace

PostgresServer::PostgresServer(std::vector<std::string> settings, int port)
    : settings_(std::move(settings)), port_(port), directory_(place()) {
  if (::mkdtemp(directory_.data()) == nullptr) throw std::runtime_error("cannot make " + directory_);
  if (const passwd* const user = ::getuid() == 0 ? ::getpwnam("postgres") : nullptr)
    if (::chown(directory_.c_str(), user->pw_uid, user->pw_gid) != 0)
      throw std::runtime_error("cannot give away " + directory_);
  int status = 0;
  const pid_t maker = spawn({programs + "/initdb", "--auth=trust", "--username=signorini", "--encoding=UTF8",
                             "--locale=C", "--no-sync", directory_ + "/data"},
                            directory_ + "/log");
  if (::waitpid(maker, &status, 0) != maker || status != 0)
    throw std::runtime_error("initdb failed; see " + directory_ + "/log");
  start();
}

PostgresServer::~PostgresServer() {
  end(SIGQUIT);
  std::filesystem::remove_all(directory_);
}

std::string PostgresServer::url(const std::string& database) const {
  return "postgresql://signorini@/" + database + "?host=" + directory_ + "&port=" + std::to_string(port_);
}

std::string PostgresServer::new_database(const std::string& name) {
  postgres::Connection(url("postgres"), 10s).script("CREATE DATABASE " + name + " STRATEGY file_copy");
  return url(name);
}

void PostgresServer::drop_database(const std::string& name) {
  postgres::Connection(url("postgres"), 10s).script("DROP DATABASE IF EXISTS " + name + " WITH (FORCE)");
}

void PostgresServer::start() {
  std::vector<std::string> command{programs + "/postgres", "-D", directory_ + "/data", "-k", directory_, "-p",
                                   std::to_string(port_)};
  for (const char* setting : {"listen_addresses=", "shared_buffers=32MB", "max_connections=100", "fsync=off"})
    command.insert(command.end(), {"-c", setting});
  for (const std::string& setting : settings_) command.insert(command.end(), {"-c", setting});
  for (int i = 0; i < 1000; ++i) {
    // One that was killed leaves processes, beside which no new one starts for a moment.
    if (pid_ < 0 || ::waitpid(pid_, nullptr, WNOHANG) == pid_) pid_ = spawn(command, directory_ + "/log");
    try {
      const postgres::Connection connection(url("postgres"), 10s);
      return;
    } catch (const postgres::Error&) {
      std::this_thread::sleep_for(20ms);
    }
  }
  throw std::runtime_error("PostgreSQL did not start; see " + directory_ + "/log");
}

void PostgresServer::end(int signal) {
  if (pid_ < 0) return;
  ::kill(pid_, signal);
  ::waitpid(pid_, nullptr, 0);
  pid_ = -1;
}

PostgresServer& shared_postgres() {
  static PostgresServer server;
  return server;
}

std::string empty_database() {
  static std::atomic<int> made = 0;
  constexpr int at_once = 4;  // that a test uses, at most
  const int number = ++made;
  if (number > at_once) shared_postgres().drop_database("store_" + std::to_string(number - at_once));
  return shared_postgres().new_database("store_" + std::to_string(number));
}

}  // namespace signorini::server
