#include "server/jobs/sqlite/file_limit.hpp"

#include <system_error>

#include <sys/resource.h>

namespace signorini::server {
namespace {

std::uintmax_t length_of(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t length = std::filesystem::file_size(file, error);
  return error ? 0 : length;
}

}  // namespace

std::optional<std::string> limit_of_growth(const std::filesystem::path& database, std::uintmax_t bytes) {
  rlimit limit{};
  if (getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
  // What is in the log goes into the database.
  const std::uintmax_t length = length_of(database) + length_of(database.string() + "-wal");
  if (length + bytes <= limit.rlim_cur) return std::nullopt;
  return "no file of the service may be longer than " + std::to_string(limit.rlim_cur) +
         " bytes (ulimit -f), and the database in the data directory has come close to that";
}

}  // namespace signorini::server
