#include "server/config.hpp"

#include <cstdlib>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>

#include "temporary_directory.hpp"

namespace signorini::server::config_test {
namespace {

CommandLine read(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "signorinid");
  return read_command_line(static_cast<int>(arguments.size()), arguments.data());
}

TEST(Config, HasTheDefaultsOfTheContract) {
  const CommandLine line = read({});
  ASSERT_FALSE(line.exit_code);
  EXPECT_EQ(line.config.daemon.host, "127.0.0.1");
  EXPECT_EQ(line.config.daemon.port, 8080);
  EXPECT_EQ(line.config.daemon.workers, 2);
  EXPECT_EQ(line.config.daemon.data_dir, "./data");
  EXPECT_EQ(line.config.daemon.max_body_bytes, std::size_t{16} << 20);
  EXPECT_FALSE(line.config.solve);
}

TEST(Config, TakesFlagsAndUnits) {
  const CommandLine line =
      read({"--port", "0", "--keep-bytes", "2mb", "--cache-bytes", "3kb", "--max-body-bytes=4096",
            "--max-unknowns=7", "--keep-seconds", "60", "--data-dir", "/var/lib/signorini"});
  ASSERT_FALSE(line.exit_code);
  EXPECT_EQ(line.config.daemon.port, 0);
  EXPECT_EQ(line.config.daemon.keep_bytes, std::size_t{2} << 20);
  EXPECT_EQ(line.config.daemon.cache_bytes, std::size_t{3} << 10);
  EXPECT_EQ(line.config.daemon.max_body_bytes, 4096u);
  EXPECT_EQ(line.config.daemon.max_unknowns, 7);
  EXPECT_EQ(line.config.daemon.keep_seconds, 60);
  EXPECT_EQ(line.config.daemon.data_dir, "/var/lib/signorini");
}

TEST(Config, SaysWhoMayAskAndHowOften) {
  const DaemonConfig unlimited = read({}).config.daemon;
  EXPECT_EQ(unlimited.rate, 0);
  EXPECT_EQ(unlimited.token_file, "");
  EXPECT_FALSE(unlimited.insecure);
  EXPECT_TRUE(unlimited.cors_origins.empty());
  const DaemonConfig limited =
      read({"--rate", "2.5", "--token-file", "tokens", "--insecure", "--max-memory", "2gb", "--cors-origin",
            "https://a.example", "--cors-origin", "https://b.example"})
          .config.daemon;
  EXPECT_EQ(read({"--allow-host", "a.example,b.example"}).config.daemon.allowed_hosts,
            (std::vector<std::string>{"a.example", "b.example"}));
  EXPECT_EQ(limited.rate, 2.5);
  EXPECT_EQ(limited.token_file, "tokens");
  EXPECT_TRUE(limited.insecure);
  EXPECT_EQ(limited.max_memory, std::size_t{2} << 30);
  EXPECT_EQ(limited.cors_origins, (std::vector<std::string>{"https://a.example", "https://b.example"}));
}

TEST(Config, RefusesBadFlagsWithExitCode2) {
  for (const std::vector<const char*>& flags :
       std::vector<std::vector<const char*>>{{"--port", "65536"},
                                             {"--port", "http"},
                                             {"--workers", "0"},
                                             {"--queue-limit", "0"},
                                             {"--no-such-flag"},
                                             {"--data-dir", ""},
                                             {"--keep-seconds", "0"},
                                             {"--keep-seconds", "soon"},
                                             {"--log-level", "loud"},
                                             {"--max-body-bytes", "12"},
                                             {"--keep-bytes", "-1"},
                                             {"--max-unknowns", "0"},
                                             {"--max-memory", "1"},
                                             {"--rate", "-1"},
                                             {"--max-subscribers", "0"},
                                             {"--factorization", "lu"},
                                             {"solve", "--factorization", "lu", "-"},
                                             {"solve"},
                                             {"solve", "a", "b"},
                                             {"stray"}}) {
    EXPECT_EQ(read(flags).exit_code, 2) << flags.front() << (flags.size() > 1 ? flags[1] : "");
  }
}

TEST(Config, HelpAndVersionAreNoErrors) {
  EXPECT_EQ(read({"--help"}).exit_code, 0);
  EXPECT_EQ(read({"--version"}).exit_code, 0);
  EXPECT_EQ(read({"solve", "--help"}).exit_code, 0);
}

TEST(Config, ReadsTheEnvironmentAndChecksIt) {
  setenv("SIGNORINI_MAX_BODY_BYTES", "1mb", 1);
  setenv("SIGNORINI_PORT", "1234", 1);
  EXPECT_EQ(read({}).config.daemon.max_body_bytes, std::size_t{1} << 20);
  EXPECT_EQ(read({}).config.daemon.port, 1234);
  EXPECT_EQ(read({"--port", "99"}).config.daemon.port, 99);
  setenv("SIGNORINI_PORT", "many", 1);
  EXPECT_EQ(read({}).exit_code, 2);
  unsetenv("SIGNORINI_PORT");
  unsetenv("SIGNORINI_MAX_BODY_BYTES");
}

/// A file with this text, which is there as long as the object.
class ConfigFile {
 public:
  explicit ConfigFile(const std::string& text) : path_(directory_.path() + "/signorinid.toml") {
    std::ofstream(path_) << text;
  }
  const char* path() const { return path_.c_str(); }

 private:
  TemporaryDirectory directory_;
  std::string path_;
};

TEST(Config, AFlagCountsBeforeTheEnvironmentAndThatBeforeTheFile) {
  const ConfigFile file("port = 1\nworkers = 3\nhost = \"127.0.0.2\"\nkeep-bytes = \"2mb\"\n");
  setenv("SIGNORINI_PORT", "2", 1);
  setenv("SIGNORINI_WORKERS", "4", 1);
  const CommandLine line = read({"--config", file.path(), "--workers", "5"});
  unsetenv("SIGNORINI_PORT");
  unsetenv("SIGNORINI_WORKERS");
  ASSERT_FALSE(line.exit_code);
  EXPECT_EQ(line.config.daemon.workers, 5);
  EXPECT_EQ(line.config.daemon.port, 2);
  EXPECT_EQ(line.config.daemon.host, "127.0.0.2");
  EXPECT_EQ(line.config.daemon.keep_bytes, std::size_t{2} << 20);
}

TEST(Config, RefusesAFileWithFaultsWithExitCode2) {
  for (const char* text : {"prot = 1\n", "port = \"http\"\n", "workers = 0\n"})
    EXPECT_EQ(read({"--config", ConfigFile(text).path()}).exit_code, 2) << text;
  EXPECT_EQ(read({"--config", "/nonexistent"}).exit_code, 2);
}

TEST(Config, IsPrintedAsAFileThatCanBeReadBack) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(read({"--port", "17", "--keep-bytes", "3kb", "--data-dir", "a b", "--log-format", "json",
                  "--print-config"})
                .exit_code,
            0);
  const ConfigFile file(testing::internal::GetCapturedStdout());
  const CommandLine line = read({"--config", file.path()});
  ASSERT_FALSE(line.exit_code);
  EXPECT_EQ(line.config.daemon.port, 17);
  EXPECT_EQ(line.config.daemon.keep_bytes, std::size_t{3} << 10);
  EXPECT_EQ(line.config.daemon.data_dir, "a b");
  EXPECT_EQ(line.config.log_format, "json");
}

TEST(Config, KeepsSolvesInADirectoryOrInADatabase) {
  const CommandLine line = read({"--database", "postgresql://db/jobs", "--role", "worker"});
  ASSERT_FALSE(line.exit_code);
  EXPECT_EQ(line.config.daemon.database, "postgresql://db/jobs");
  EXPECT_EQ(line.config.daemon.role, Role::worker);
  EXPECT_EQ(read({}).config.daemon.role, Role::all);
  EXPECT_EQ(read({"--database", "postgresql://db/jobs", "--data-dir", "/data"}).exit_code, 2);
  EXPECT_EQ(read({"--database", "db/jobs"}).exit_code, 2);
  EXPECT_EQ(read({"--database", "postgresql://db/jobs", "--role", "boss"}).exit_code, 2);
  EXPECT_EQ(read({"--role", "front"}).exit_code, 2);
  setenv("SIGNORINI_DATA_DIR", "/data", 1);
  setenv("SIGNORINI_DATABASE", "postgres://db/jobs", 1);
  EXPECT_EQ(read({}).exit_code, 2);
  setenv("SIGNORINI_DATA_DIR", "", 1);
  EXPECT_EQ(read({}).config.daemon.database, "postgres://db/jobs");
  unsetenv("SIGNORINI_DATA_DIR");
  unsetenv("SIGNORINI_DATABASE");
}

TEST(Config, IsPrintedWithoutThePasswordOfTheDatabase) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(
      read({"--database", "postgresql://anne:secret@db/jobs?password=secret", "--print-config"}).exit_code,
      0);
  const std::string printed = testing::internal::GetCapturedStdout();
  EXPECT_EQ(printed.find("secret"), std::string::npos) << printed;
  EXPECT_EQ(read({"--config", ConfigFile(printed).path()}).config.daemon.database,
            "postgresql://anne@db/jobs?");
}

TEST(Config, NamesTheFactorisationOfTheServiceAndOfTheCommands) {
  EXPECT_EQ(read({}).config.daemon.factorization, Factorization::multifrontal);
  EXPECT_EQ(read({"--factorization", "cholmod"}).config.daemon.factorization, Factorization::cholmod);
  EXPECT_EQ(read({"solve", "-"}).config.solve->factorization, Factorization::multifrontal);
  EXPECT_EQ(read({"solve", "--factorization", "cholmod", "-"}).config.solve->factorization,
            Factorization::cholmod);
  EXPECT_EQ(read({"--factorization", "cholmod", "study", "-"}).config.study->factorization,
            Factorization::cholmod);
  setenv("SIGNORINI_FACTORIZATION", "cholmod", 1);
  EXPECT_EQ(read({}).config.daemon.factorization, Factorization::cholmod);
  EXPECT_EQ(read({"solve", "-"}).config.solve->factorization, Factorization::cholmod);
  EXPECT_EQ(read({"solve", "--factorization", "multifrontal", "-"}).config.solve->factorization,
            Factorization::multifrontal);
  setenv("SIGNORINI_FACTORIZATION", "lu", 1);
  EXPECT_EQ(read({}).exit_code, 2);
  unsetenv("SIGNORINI_FACTORIZATION");
  const ConfigFile file("factorization = \"cholmod\"\n");
  EXPECT_EQ(read({"--config", file.path()}).config.daemon.factorization, Factorization::cholmod);
}

TEST(Config, ReadsTheSolveCommand) {
  const CommandLine line = read({"solve", "--fields", "summary,contact", "-"});
  ASSERT_TRUE(line.config.solve);
  EXPECT_EQ(line.config.solve->file, "-");
  EXPECT_EQ(line.config.solve->fields, "summary,contact");
}

}  // namespace
}  // namespace signorini::server::config_test
