#include "server/handlers/pages.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include "server/http/content.hpp"
#include "server/http/error.hpp"
#include "server/http/query.hpp"

namespace signorini::server {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view shell = "shell.html";

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

/// Throws HttpError 404.
std::string_view text_of(std::string_view file) {
  const auto found = std::ranges::find(page_files(), file, &PageFile::name);
  if (found == page_files().end()) throw not_found();
  return found->text;
}

/// `compressed`: the same text; it outlives the reply.
Response to_browser(std::string_view file, std::string_view text, const std::string& compressed) {
  Response response = Response::empty(200);
  response.content_type = content_type_of(file);
  response.body = text;
  response.compressed = &compressed;
  response.headers.emplace_back(
      "Content-Security-Policy",
      "default-src 'self'; object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
  return response;
}

}  // namespace

Handler page_of(std::string_view title, std::string_view style, std::string_view script) {
  std::string text(text_of(shell));
  for (const auto& [word, own] :
       {std::pair{"@TITLE@"sv, title}, {"@STYLE@"sv, style}, {"@SCRIPT@"sv, script}})
    text.replace(text.find(word), word.size(), own);
  const auto packed = std::make_shared<const std::string>(compressed(text, api::Effort::most));
  return [text, packed](const Request&) { return to_browser(shell, text, *packed); };
}

Response get_page_file(Service&, const Request& request) {
  allow_only(request.query, {});
  const std::string& file = request.path_parameters.at("file");
  const std::string_view text = text_of(file);
  return to_browser(file, text, compressed_files().at(file));
}

}  // namespace signorini::server
