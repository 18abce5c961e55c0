#include "server/handlers/pages.hpp"

#include <algorithm>
#include <cctype>

#include "api/examples.hpp"
#include "server/http/query.hpp"

namespace signorini::server {
namespace {

/// The host and port by which the client came, for the command line on the page. It stands in HTML and is
/// copied into a shell: only what a host may hold is taken.
std::string authority_of(const Request& request) {
  const std::string host = request.header("Host").value_or("");
  const bool plain = !host.empty() && std::all_of(host.begin(), host.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '.' || c == '-' || c == ':' || c == '[' || c == ']';
  });
  return plain ? host : "127.0.0.1:8080";
}

std::string example_links() {
  std::string items;
  for (const api::Example& example : api::examples()) {
    const std::string example_name(example.name);
    items += "<li><a href=\"/v1/examples/" + example_name + "\">" + example_name + "</a></li>\n";
  }
  return items;
}

std::string curl_lines(const std::string& base) {
  return "curl -s " + base + "/v1/examples/paper-nonconforming > problem.json\n" +
         "curl -s -H 'Content-Type: application/json' -d @problem.json '" + base +
         "/v1/solves?wait=60&amp;fields=summary'\n";
}

}  // namespace

Response get_start_page(Service&, const Request& request) {
  allow_only(request.query, {});
  return Response::html(
      "<!doctype html>\n<html lang=\"en\"><head><meta "
      "charset=\"utf-8\"><title>Signorini</title></head><body>\n"
      "<h1>Signorini</h1>\n<p>Solves frictionless contact problems by the dual mixed finite element "
      "method. <a href=\"/docs\">The interface</a>, to read and to try; the same as <a "
      "href=\"/openapi.json\">OpenAPI</a>.</p>\n"
      "<h2>Try it</h2>\n<pre>" +
      curl_lines("http://" + authority_of(request)) + "</pre>\n<h2>Examples</h2>\n<ul>\n" + example_links() +
      "</ul>\n<h2>Solves</h2>\n<p><a href=\"/v1/solves\">All solves</a>, newest "
      "first.</p>\n</body></html>\n");
}

}  // namespace signorini::server
