#include "server/config.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <string_view>

#include <CLI/CLI.hpp>

#include "server/exit_code.hpp"
#include "server/jobs/postgres/url.hpp"

namespace signorini::server {
namespace {

constexpr std::int64_t hundred_years = 100LL * 365 * 24 * 3600;

/// `queue-limit` is also read from SIGNORINI_QUEUE_LIMIT.
std::string variable_of(const std::string& name) {
  std::string variable = "SIGNORINI_" + name;
  std::transform(variable.begin(), variable.end(), variable.begin(),
                 [](unsigned char c) { return c == '-' ? '_' : static_cast<char>(std::toupper(c)); });
  return variable;
}

template <class Value>
CLI::Option* add_flag(CLI::App& app, const std::string& flag, Value& value, const std::string& help) {
  return app.add_option(flag, value, help)->envname(variable_of(flag.substr(2)))->capture_default_str();
}

/// A file in TOML, `name = value` a line. CLI11 would take the file before the environment.
class BelowEnvironment : public CLI::ConfigTOML {
 public:
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::vector<CLI::ConfigItem> found = CLI::ConfigTOML::from_config(input);
    std::erase_if(found,
                  [](const CLI::ConfigItem& item) { return std::getenv(variable_of(item.name).c_str()); });
    return found;
  }
};

void add_config_file(CLI::App& app) {
  app.config_formatter(std::make_shared<BelowEnvironment>());
  app.set_config("--config", "", "File with flags, `name = value` a line, as --print-config writes it")
      ->envname(variable_of("config"))
      ->configurable(false);
  app.allow_config_extras(CLI::config_extras_mode::error);
}

/// The code that factors, of the service and of the commands that solve without one.
class FactorizationFlag {
 public:
  void add_to(CLI::App& app) {
    add_flag(app, "--factorization", value_,
             "Code that factors: ours, or CHOLMOD, within which nothing can be cancelled")
        ->check(known_);
  }
  void add_to_command(CLI::App& command) {
    command
        .add_option("--factorization", of_command_, "Code that factors; SIGNORINI_FACTORIZATION if not given")
        ->check(known_);
  }

  Factorization value() const {
    const bool is_cholmod = (of_command_.empty() ? value_ : of_command_) == "cholmod";
    return is_cholmod ? Factorization::cholmod : Factorization::multifrontal;
  }

 private:
  const CLI::IsMember known_{{"multifrontal", "cholmod"}};
  std::string value_ = "multifrontal", of_command_;
};

/// What a service of a fleet does.
class RoleFlag {
 public:
  void add_to(CLI::App& app) {
    add_flag(app, "--role", value_,
             "What a service with a database does: all, front (HTTP only), or worker (solves only)")
        ->check(CLI::IsMember({"all", "front", "worker"}));
  }

  Role value() const {
    if (value_ == "front") return Role::front;
    return value_ == "worker" ? Role::worker : Role::all;
  }

 private:
  std::string value_ = "all";
};

/// Of a configuration that cannot be meant. Throws CLI::ValidationError.
void require_one_store(const DaemonConfig& daemon) {
  const bool has_directory = daemon.data_dir != DaemonConfig().data_dir;
  if (has_directory && !daemon.database.empty())
    throw CLI::ValidationError("--database", "is given beside --data-dir (" + daemon.data_dir +
                                                 "); solves are kept in one of the two");
  if (daemon.role != Role::all && daemon.database.empty())
    throw CLI::ValidationError("--role", "needs --database, by which services share their solves");
}

/// A number of bytes with an optional unit: 1048576, 1024kb, 1mb.
void take_bytes(CLI::Option* option, std::size_t low) {
  option->transform(CLI::AsSizeValue(false));
  option->check(CLI::Range(low, std::numeric_limits<std::size_t>::max() / 2, "BYTES"));
}

void add_access_flags(CLI::App& app, DaemonConfig& daemon) {
  add_flag(app, "--rate", daemon.rate, "Requests a second of one client; 0 is no limit")
      ->check(CLI::Range(0.0, 1e6));
  add_flag(app, "--token-file", daemon.token_file,
           "Tokens of clients, `name scopes token` a line; needed to listen beyond this machine");
  app.add_flag("--insecure", daemon.insecure, "Listens beyond this machine without tokens")
      ->envname(variable_of("insecure"));
  add_flag(app, "--cors-origin", daemon.cors_origins,
           "Origin whose pages browsers let in, such as https://example.org; several, or *, may be given")
      ->default_str("")
      ->delimiter(',')
      ->allow_extra_args(false);
  add_flag(app, "--allow-host", daemon.allowed_hosts,
           "Name other than localhost by which a service on the loopback may be reached, as by a proxy; "
           "several may "
           "be given")
      ->default_str("")
      ->delimiter(',')
      ->allow_extra_args(false);
}

void add_daemon_flags(CLI::App& app, DaemonConfig& daemon) {
  add_flag(app, "--host", daemon.host, "Address to listen on");
  add_flag(app, "--port", daemon.port, "Port to listen on; 0 takes a free one")->check(CLI::Range(0, 65535));
  add_flag(app, "--workers", daemon.workers, "Solves that run at the same time")->check(CLI::Range(1, 256));
  add_flag(app, "--data-dir", daemon.data_dir, "Directory where solves are kept; :memory: keeps nothing")
      ->check(
          CLI::Validator([](const std::string& value) { return value.empty() ? "is empty" : ""; }, "DIR"));
  add_flag(app, "--database", daemon.database,
           "PostgreSQL database where solves are kept in place of a directory, for several services: "
           "postgresql://…")
      ->check(CLI::Validator(
          [](const std::string& value) {
            const bool is_url = value.starts_with("postgresql://") || value.starts_with("postgres://");
            return value.empty() || is_url ? "" : "is no URL postgresql://USER@HOST/NAME";
          },
          "URL"));
  add_flag(app, "--lease-seconds", daemon.lease_seconds,
           "A service of a database that is silent for so long loses its solves to others")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{3600}));
  add_flag(app, "--queue-limit", daemon.queue_limit,
           "Requests that may wait, a batch being one; more are refused with 503")
      ->check(CLI::Range(1, 100000));
  take_bytes(add_flag(app, "--keep-bytes", daemon.keep_bytes,
                      "Disk or memory for ended solves; the oldest are dropped"),
             0);
  add_flag(app, "--keep-seconds", daemon.keep_seconds, "How long ended solves are kept")
      ->check(CLI::Range(std::int64_t{1}, hundred_years));
  take_bytes(add_flag(app, "--cache-bytes", daemon.cache_bytes,
                      "Memory for factors that later solves may use again; 0 keeps none"),
             0);
  take_bytes(add_flag(app, "--max-body-bytes", daemon.max_body_bytes, "Longest body of a request, decoded"),
             1024);
  add_flag(app, "--max-unknowns", daemon.max_unknowns, "Most stress unknowns of a problem")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 40));
  take_bytes(add_flag(app, "--max-memory", daemon.max_memory,
                      "Memory for the solves that run at the same time, as predicted"),
             std::size_t{1} << 20);
  add_flag(app, "--max-subscribers", daemon.max_subscribers, "Streams of events that may be open")
      ->check(CLI::Range(1, 100000));
  add_flag(app, "--drain-seconds", daemon.drain_seconds,
           "The service ends within so long after SIGTERM; solves that run are queued again")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{3600}));
  add_access_flags(app, daemon);
}

/// A command with options of its own, which no configuration file has.
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& help) {
  CLI::App* command = app.add_subcommand(name, help);
  command->option_defaults()->configurable(false);
  return command;
}

CLI::App* add_solve(CLI::App& app, SolveConfig& solve) {
  CLI::App* command =
      add_command(app, "solve", "Solve one problem without a server; the result goes to stdout");
  command->add_option(
      "--fields", solve.fields,
      "Members of the result, e.g. summary,contact (all if not given; summary is always there)");
  command
      ->add_option("--format", solve.format,
                   "Of the result: table to read (at a terminal), json (else), cbor, vtu for ParaView, svg, "
                   "a picture, "
                   "or csv")
      ->check(CLI::IsMember({"table", "json", "cbor", "vtu", "svg", "csv"}));
  command->add_option(
      "--field", solve.field,
      "What the picture shows: displacement, stress, von_mises, error, contact, history; of the last "
      "two also what the csv has");
  command->add_option("--deformed", solve.deformed,
                      "So many times the displacement moves the points of a picture");
  command->add_option("--series", solve.series,
                      "Directory for series.pvd and a .vtu of each level of the mesh, or entry of the sweep");
  command->add_option("FILE", solve.file, "Problem document; - reads standard input")->required();
  return command;
}

CLI::App* add_study(CLI::App& app, StudyConfig& study) {
  CLI::App* command =
      add_command(app, "study", "Solve the study of one problem without a server; its table goes to stdout");
  command->add_option("--format", study.format, "Of the table: table to read, json or csv")
      ->capture_default_str()
      ->check(CLI::IsMember({"table", "json", "csv"}));
  command->add_option("FILE", study.file, "Problem document with a study; - reads standard input")
      ->required();
  return command;
}

CLI::App* add_inf_sup(CLI::App& app, InfSupConfig& inf_sup) {
  CLI::App* command = add_command(
      app, "inf-sup",
      "Compute the Babuska-Brezzi constant of a problem's scheme on its mesh, without a solve or a server");
  command->add_option("--format", inf_sup.format, "Of the answer: table to read, or json")
      ->capture_default_str()
      ->check(CLI::IsMember({"table", "json"}));
  command->add_option("FILE", inf_sup.file, "Problem document; - reads standard input")->required();
  return command;
}

CLI::App* add_check(CLI::App& app, CheckConfig& check) {
  CLI::App* command = add_command(
      app, "check", "Look through a data directory that no service runs on, and repair what is damaged");
  command->add_option("DIR", check.directory, "The directory (--data-dir)")->required();
  return command;
}

/// Kubernetes sets SIGNORINI_PORT=tcp://… in every pod beside a Service that is called `signorini`.
void forget_service_link() {
  const std::string variable = variable_of("port");
  const char* const port = std::getenv(variable.c_str());
  if (port != nullptr && std::string_view(port).starts_with("tcp://")) ::unsetenv(variable.c_str());
}

int exit_code_of(CLI::App& app, const CLI::ParseError& error) {
  return app.exit(error) == 0 ? exit_done : exit_bad_input;
}

}  // namespace

CommandLine read_command_line(int argc, const char* const* argv) {
  forget_service_link();
  CommandLine line;
  SolveConfig solve;
  FactorizationFlag factorization;
  CLI::App app("Signorini: frictionless contact by the dual mixed finite element method, as an HTTP service");
  app.set_version_flag("--version", "signorinid " SIGNORINI_VERSION)->configurable(false);
  add_config_file(app);
  bool print_config = false;
  app.add_flag("--print-config", print_config, "Write the configuration as a file for --config, and end")
      ->configurable(false);
  add_flag(app, "--log-level", line.config.log_level, "What goes to standard error")
      ->check(CLI::IsMember({"debug", "info", "warn", "error", "off"}));
  add_flag(app, "--log-format", line.config.log_format, "How it is written there")
      ->check(CLI::IsMember({"text", "json"}));
  add_daemon_flags(app, line.config.daemon);
  factorization.add_to(app);
  RoleFlag role;
  role.add_to(app);
  StudyConfig study;
  CLI::App* const solve_command = add_solve(app, solve);
  CLI::App* const study_command = add_study(app, study);
  for (CLI::App* const command : {solve_command, study_command}) factorization.add_to_command(*command);
  InfSupConfig inf_sup;
  const CLI::App* inf_sup_command = add_inf_sup(app, inf_sup);
  CheckConfig check;
  const CLI::App* check_command = add_check(app, check);
  CLI::App* const health_command = add_command(
      app, "health", "Ask the service on --host and --port whether it lives; exit code 0 if it does");
  health_command->fallthrough();  // the flags of the service may stand behind it
  try {
    app.parse(argc, argv);
    line.config.daemon.factorization = solve.factorization = study.factorization = factorization.value();
    line.config.daemon.role = role.value();
    require_one_store(line.config.daemon);
    if (solve_command->parsed()) line.config.solve = solve;
    if (study_command->parsed()) line.config.study = study;
    if (inf_sup_command->parsed()) line.config.inf_sup = inf_sup;
    if (check_command->parsed()) line.config.check = check;
    line.config.health = health_command->parsed();
    if (print_config) {
      std::cout << postgres::without_password(app.config_to_str(true, true));
      line.exit_code = exit_done;
    }
  } catch (const CLI::ParseError& error) {
    line.exit_code = exit_code_of(app, error);
  }
  return line;
}

}  // namespace signorini::server
