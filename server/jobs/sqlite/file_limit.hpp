#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace signorini::server {

/// Why a database and its log may not grow by so many bytes, in words: no file of this process may be longer
/// than RLIMIT_FSIZE says, whatever room the disk has. Nothing if they may.
std::optional<std::string> limit_of_growth(const std::filesystem::path& database, std::uintmax_t bytes);

}  // namespace signorini::server
