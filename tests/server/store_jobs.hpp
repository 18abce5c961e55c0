#pragma once

#include <string>
#include <vector>

#include "server/jobs/store.hpp"

namespace signorini::server {

constexpr std::size_t plenty = std::size_t{1} << 40;

NewJob new_job(const std::string& id, const std::string& problem = "{}",
               const std::optional<std::string>& key = std::nullopt);

/// With three iterations and a field of about so many bytes, which cannot be compressed.
Ending success(std::size_t bytes = 0);

std::vector<std::string> ids(const JobPage& page);

}  // namespace signorini::server
