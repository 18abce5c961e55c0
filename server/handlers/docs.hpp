#pragma once

#include <string_view>
#include <vector>

#include "server/handlers/service.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

/// A file of the page that shows the OpenAPI document; the files of server/pages, compiled in.
struct Page {
  std::string_view name;  ///< with its ending
  std::string_view text;
};

const std::vector<Page>& pages();

/// `GET /openapi.json`.
Response get_openapi(Service& service, const Request& request);

/// `GET /docs`: the OpenAPI document, to read and to try.
Response get_docs(Service& service, const Request& request);

/// `GET /docs/{file}`: what that page consists of.
Response get_docs_file(Service& service, const Request& request);

}  // namespace signorini::server
