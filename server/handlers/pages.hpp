#pragma once

#include <string_view>
#include <vector>

#include "server/handlers/service.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"
#include "server/http/router.hpp"

namespace signorini::server {

/// What a browser loads: the shell of the pages, styles and scripts; the files of server/pages, compiled in.
struct PageFile {
  std::string_view name;  ///< with its ending
  std::string_view text;
};

const std::vector<PageFile>& page_files();

/// Shows a page: shell.html with a title, and with the style and the script of these names. What it loads
/// comes from this service alone, and the browser is told so.
Handler page_of(std::string_view title, std::string_view style, std::string_view script);

/// `GET /pages/{file}`.
Response get_page_file(Service& service, const Request& request);

}  // namespace signorini::server
