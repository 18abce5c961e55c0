#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "api/document/gzip.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

/// Writes a body of at most 256 KiB beforehand: it is sent whole, with its length, and what goes wrong while
/// it is written can still be told by the status.
void take_if_short(Response& response);

/// The text by gzip.
std::string compressed(std::string_view text, api::Effort effort = api::Effort::least);

/// Compresses the body by gzip, if there is one and it is long enough to gain by it.
void compress(Response& response);

/// Throws HttpError 415 for content codings that decoded() does not know.
void require_known(const std::vector<std::string>& codings);

/// A body without its content codings (RFC 9110, 8.4.1), of at most so many bytes. Throws HttpError 415 if it
/// has a coding that is not known, 400 if it is not what that says, to its end, and 413 if it is longer.
std::string decoded(std::string body, const std::vector<std::string>& codings, std::size_t max_bytes);

}  // namespace signorini::server
