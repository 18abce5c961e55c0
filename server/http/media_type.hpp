#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace signorini::server {

/// True for `application/json` and `application/…+json`, whatever parameters follow.
bool is_json(std::string_view content_type);

/// True for `application/cbor` and `application/…+cbor`, whatever parameters follow.
bool is_cbor(std::string_view content_type);

/// The one of the media types that an Accept header (RFC 9110, 12.5.1) gives the largest weight; of several
/// the one that it names most specifically, and then the first. Nothing if it takes none of them; without a
/// header everything is taken.
std::optional<std::string> preferred(const std::optional<std::string>& accept,
                                     const std::vector<std::string>& media_types);

/// Whether an Accept-Encoding header (RFC 9110, 12.5.3) takes the coding, by its name or by `*`, and does not
/// rank a plain body above it.
bool accepts_coding(std::string_view accept_encoding, std::string_view coding);

}  // namespace signorini::server
