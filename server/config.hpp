#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "problem/settings.hpp"
#include "server/machine_memory.hpp"

namespace signorini::server {

/// What one process of a fleet does: all of it, the HTTP alone, or the solves alone.
enum class Role { all, front, worker };

/// `signorinid`: every flag with its default; each is also read from SIGNORINI_<FLAG>, and from a file.
struct DaemonConfig {
  std::string host = "127.0.0.1";
  int port = 8080;
  int workers = 2;
  std::string data_dir = "./data";
  std::string database;  ///< postgresql://…, in place of a directory; empty: none
  std::int64_t lease_seconds = 10;
  Role role = Role::all;
  std::size_t queue_limit = 64;
  std::size_t keep_bytes = std::size_t{1} << 30;
  std::int64_t keep_seconds = 7 * 24 * 3600;
  std::size_t cache_bytes = std::size_t{512} << 20;
  std::size_t max_body_bytes = std::size_t{16} << 20;
  std::int64_t max_unknowns = 20'000'000;
  std::size_t max_memory = machine_memory() / 4 * 3;
  std::size_t max_subscribers = 1000;
  double rate = 0;  ///< requests a second of one client; 0: no limit
  std::string token_file;
  bool insecure = false;
  std::vector<std::string> cors_origins;
  std::vector<std::string> allowed_hosts;
  std::int64_t drain_seconds = 20;
  Factorization factorization = Factorization::multifrontal;
};

/// `signorinid solve`.
struct SolveConfig {
  std::string file;    ///< `-` is standard input
  std::string fields;  ///< empty: all
  std::string format;  ///< `table`, `json`, `cbor`, `vtu`, `svg` or `csv`; empty: for whoever reads it
  std::string field;   ///< what a picture shows or a CSV has; empty: the displacement, the contact
  std::optional<double> deformed;
  std::string series;  ///< directory for a series of .vtu files; empty: none
  Factorization factorization = Factorization::multifrontal;
};

/// `signorinid study`.
struct StudyConfig {
  std::string file;              ///< `-` is standard input
  std::string format = "table";  ///< or `json` or `csv`
  Factorization factorization = Factorization::multifrontal;
};

/// `signorinid inf-sup`.
struct InfSupConfig {
  std::string file;              ///< `-` is standard input
  std::string format = "table";  ///< or `json`
};

/// `signorinid check`.
struct CheckConfig {
  std::string directory;
};

struct Config {
  std::string log_level = "info";
  std::string log_format = "text";  ///< or `json`
  DaemonConfig daemon;
  // One of these is set if that is what is asked.
  std::optional<SolveConfig> solve;
  std::optional<StudyConfig> study;
  std::optional<InfSupConfig> inf_sup;
  std::optional<CheckConfig> check;
  bool health = false;  ///< `signorinid health`
};

/// What the command line asks for, or the exit code after a text was written instead: help, the version, the
/// configuration, or what is wrong with the flags.
struct CommandLine {
  Config config;
  std::optional<int> exit_code;
};

/// A flag counts before the environment, that before the file of `--config`, and that before the default.
CommandLine read_command_line(int argc, const char* const* argv);

}  // namespace signorini::server
