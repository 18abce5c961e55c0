#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "api/document/piece_writer.hpp"
#include "server/jobs/run.hpp"
#include "server/series.hpp"

/// What the commands share that solve a problem without a server.
namespace signorini::server {

/// The input cannot be taken; no solve was begun.
struct BadInput {
  ProblemDetails details;
  std::optional<int> status = std::nullopt;
};

/// The text of a file; `-` is standard input. Throws BadInput.
std::string read_input(const std::string& file);

/// Its problem. Throws BadInput.
api::Request parse_input(const std::string& text);

/// Writes what a solve found out; false if the sink ended it.
using WriteEnding = std::function<bool(const Ending& ending, const api::Sink& sink)>;

/// Solves the problem until a signal ends it: what `write` writes to standard output, what went wrong as
/// problem+json to standard error, and if that is a terminal how far it is. Adds to the series if there is
/// one. Returns the exit code.
int solve_and_write(const api::Request& request, const WriteEnding& write, Series* series = nullptr);

/// The same of what `find` finds without a Solution; `triangles`: of the mesh, about.
int find_and_write(std::int64_t triangles, const std::function<void(Observer&)>& find,
                   const std::function<bool(const api::Sink& sink)>& write);

/// What the command returns, or the exit code for the BadInput that it throws, which goes to standard error.
int run_locally(const std::function<int()>& command);

}  // namespace signorini::server
