#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "server/jobs/batch.hpp"
#include "server/jobs/live_solve.hpp"

namespace signorini::server {

// The bytes by which a store on disk keeps things, the same on every machine. What is read back is equal to
// the last bit. Unpacking bytes that are damaged throws std::runtime_error.

/// Compressed, with a checksum.
std::string pack_text(const std::string& text);
std::string unpack_text(const std::string& bytes);

/// Short and read often: not compressed.
std::string pack_verdict(const Verdict& verdict);
Verdict unpack_verdict(const std::string& bytes);

/// A list of texts, empty for none.
std::string pack_list(const std::vector<std::string>& list);
std::vector<std::string> unpack_list(const std::string& packed);

/// Of a batch what is one value: its title, its tags and the ids of its jobs; compressed, with a checksum.
std::string pack_content(const Batch& batch);
void unpack_content(const std::string& bytes, Batch& batch);

/// How far a solve is, and what it has iterated. Short and soon forgotten: not compressed.
std::string pack_progress(const Progress& progress);
Progress unpack_progress(const std::string& bytes);
std::string pack_iterations(const std::vector<Iteration>& iterations);
std::vector<Iteration> unpack_iterations(const std::string& bytes);

/// Reads stored bytes from a place on, as many as there is room for, or as are left.
using ReadBytes = std::function<std::size_t(std::size_t offset, std::span<char> room)>;

/// The solution and the history; compressed, with a checksum. Unpacking takes hardly more memory than what is
/// unpacked: it reads the bytes twice, first to see that they are not damaged.
std::string pack_findings(const Ending& ending);
void unpack_findings(const ReadBytes& packed, JobResult& result);

/// About how much memory is taken by what unpack_findings() makes of the bytes, by what they say.
std::size_t unpacked_size(const ReadBytes& packed);

}  // namespace signorini::server
