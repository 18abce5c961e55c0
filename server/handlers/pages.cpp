#include "server/handlers/pages.hpp"

#include <algorithm>
#include <map>

#include "server/http/content.hpp"
#include "server/http/error.hpp"
#include "server/http/query.hpp"

namespace signorini::server {
namespace {

/// By the ending of the name.
std::string content_type_of(std::string_view file) {
  const std::string_view ending = file.substr(file.find('.') + 1);
  if (ending == "svg") return "image/svg+xml";
  return "text/" + std::string(ending == "js" ? "javascript" : ending) + "; charset=utf-8";
}

/// By gzip; they are the same at every request.
const std::map<std::string_view, std::string>& compressed_files() {
  static const auto all = [] {
    std::map<std::string_view, std::string> made;
    for (const PageFile& file : page_files())
      made.emplace(file.name, compressed(file.text, api::Effort::most));
    return made;
  }();
  return all;
}

}  // namespace

Response page_response(std::string_view file) {
  const auto page = std::ranges::find(page_files(), file, &PageFile::name);
  if (page == page_files().end()) throw not_found();
  Response response = Response::empty(200);
  response.content_type = content_type_of(file);
  response.body = page->text;
  response.compressed = &compressed_files().at(file);
  response.headers.emplace_back(
      "Content-Security-Policy",
      "default-src 'self'; object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
  return response;
}

Response get_page_file(Service&, const Request& request) {
  allow_only(request.query, {});
  return page_response(request.path_parameters.at("file"));
}

}  // namespace signorini::server
