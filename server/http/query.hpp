#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "server/http/error.hpp"
#include "server/http/request.hpp"

namespace signorini::server {

/// The text in which octets are percent-encoded, and a plus is a blank.
std::string percent_decoded(std::string_view text);

/// The text as a value in a query, with all but RFC 3986's unreserved characters percent-encoded.
std::string percent_encoded(std::string_view text);

/// Reads `name=value&...` with percent-encoded names and values, in which a plus is a blank.
Query read_query(std::string_view text);

/// Refuses every query parameter that is not among the allowed ones, stands twice or has no value: 400.
void allow_only(const Query& query, std::initializer_list<std::string_view> allowed);

std::optional<std::string> parameter(const Query& query, const std::string& name);

/// A number within [low, high], else 400.
std::optional<double> number_parameter(const Query& query, const std::string& name, double low, double high);
std::optional<long> integer_parameter(const Query& query, const std::string& name, long low, long high);

/// 400 that names the parameter and what it may be.
HttpError bad_parameter(const std::string& name, const std::string& detail);

}  // namespace signorini::server
