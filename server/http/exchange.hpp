#pragma once

#include <httplib.h>

#include "server/http/connection.hpp"
#include "server/http/dispatch.hpp"

namespace signorini::server {

/// Makes what httplib has read safe to work with, before anything else sees it: the id of the request
/// (the client's if it is sane), no ranges, and what codings the client takes out of httplib's sight, which
/// would compress with brotli or gzip at full effort.
void sanitize(httplib::Request& request);

/// Answers one request of httplib, which came on this connection, by the route table; there is no reader for
/// methods without a body.
void exchange(const Router& router, Connection& connection, const httplib::Request& from,
              httplib::Response& to, const httplib::ContentReader* reader);

/// Turns a refusal that httplib pronounced by itself into problem+json.
void explain_refusal(const Router& router, const httplib::Request& from, httplib::Response& to);

/// Headers that httplib adds and that are not true here.
void correct_headers(const httplib::Request& from, httplib::Response& to);

}  // namespace signorini::server
