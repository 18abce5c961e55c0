#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>

#include "server/access/identity.hpp"

namespace signorini::server {

/// The file of tokens cannot be used; the text names the cause and the remedy.
class BadTokenFile : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The secrets by which clients are known (RFC 6750).
class BearerTokens {
 public:
  /// None: everybody is let in, and may do everything.
  BearerTokens() = default;

  /// From a file with a token a line, of at least 16 visible ASCII characters: `name scopes token`, with
  /// `scopes` comma-separated out of `read`, `solve`, `admin` and `metrics`, and limits of the name after it:
  /// `queue=N` jobs that wait, `memory=BYTES` (with a unit: 2gb) for those that run, `rate=N` requests a
  /// second. A line with a token alone has a name of its own, and `read,solve`. A name may have several
  /// tokens, with the same limits. The log shows none of them. Throws BadTokenFile.
  explicit BearerTokens(std::string file);

  /// Reads the file again. Throws BadTokenFile; then all stays as it was.
  void reload();

  /// Whom an Authorization header names; nothing if it may not pass. How long that takes tells nothing of the
  /// tokens.
  std::optional<Identity> identify(const std::optional<std::string>& authorization) const;

  /// Counts a request, and returns how long its sender has to wait before one is taken: zero if this one is.
  std::chrono::duration<double> count(const Identity& identity) const;

 private:
  struct Table;
  static std::shared_ptr<const Table> read(const std::string& file);
  std::shared_ptr<const Table> table() const;

  std::string file_;
  mutable std::mutex mutex_;
  std::shared_ptr<const Table> table_;
};

}  // namespace signorini::server
