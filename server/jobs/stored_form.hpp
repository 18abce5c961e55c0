#pragma once

#include <string>

#include "server/jobs/job.hpp"

namespace signorini::server {

// The bytes by which a store on disk keeps things, the same on every machine. What is read back is equal to
// the last bit. Unpacking bytes that are damaged throws std::runtime_error.

/// Compressed, with a checksum.
std::string pack_text(const std::string& text);
std::string unpack_text(const std::string& bytes);

/// Short and read often: not compressed.
std::string pack_verdict(const Verdict& verdict);
Verdict unpack_verdict(const std::string& bytes);

/// The solution and the history; compressed, with a checksum.
std::string pack_findings(const Ending& ending);
void unpack_findings(const std::string& bytes, JobResult& result);

}  // namespace signorini::server
