#include "server/handlers/docs.hpp"

#include <algorithm>

#include "api/openapi.hpp"
#include "server/http/content.hpp"
#include "server/http/error.hpp"
#include "server/http/query.hpp"

namespace signorini::server {
namespace {

/// By the ending of the name.
std::string content_type_of(std::string_view file) {
  const std::string_view ending = file.substr(file.find('.') + 1);
  return "text/" + std::string(ending == "js" ? "javascript" : ending) + "; charset=utf-8";
}

Response page_response(std::string_view file) {
  const auto page = std::ranges::find(pages(), file, &Page::name);
  if (page == pages().end()) throw not_found();
  Response response = Response::empty(200);
  response.content_type = content_type_of(file);
  response.body = page->text;
  // What the page shows comes from this service, and so does all that it loads.
  response.headers.emplace_back(
      "Content-Security-Policy",
      "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
      "base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
  return response;
}

}  // namespace

Response get_openapi(Service&, const Request& request) {
  allow_only(request.query, {});
  static const std::string compressed_document = compressed(api::openapi_document());
  Response response = Response::json(200, api::openapi_document());
  response.compressed = &compressed_document;
  return response;
}

Response get_docs(Service&, const Request& request) {
  allow_only(request.query, {});
  return page_response("docs.html");
}

Response get_docs_file(Service&, const Request& request) {
  allow_only(request.query, {});
  return page_response(request.path_parameters.at("file"));
}

}  // namespace signorini::server
