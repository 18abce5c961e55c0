#pragma once

#include <string_view>
#include <vector>

#include "server/handlers/service.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

/// What a browser loads: pages, their styles and scripts; the files of server/pages, compiled in.
struct PageFile {
  std::string_view name;  ///< with its ending
  std::string_view text;
};

const std::vector<PageFile>& page_files();

/// One of them. What it shows comes from this service alone, and the browser is told so. Throws HttpError
/// 404.
Response page_response(std::string_view file);

/// `GET /pages/{file}`.
Response get_page_file(Service& service, const Request& request);

}  // namespace signorini::server
