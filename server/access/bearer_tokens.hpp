#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace signorini::server {

/// The file of tokens cannot be used; the text names the cause and the remedy.
class BadTokenFile : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The secrets by which clients are known (RFC 6750).
class BearerTokens {
 public:
  /// None: everybody is let in.
  BearerTokens() = default;
  /// One a line, of at least 16 visible ASCII characters. Throws BadTokenFile.
  explicit BearerTokens(const std::string& file);

  /// Whether an Authorization header may pass. How long that takes tells nothing of the tokens.
  bool accept(const std::optional<std::string>& authorization) const;

 private:
  std::vector<std::string> tokens_;
};

}  // namespace signorini::server
