#include "server/handlers/openapi.hpp"

#include "api/openapi.hpp"
#include "server/http/content.hpp"
#include "server/http/query.hpp"

namespace signorini::server {

Response get_openapi(Service&, const Request& request) {
  allow_only(request.query, {});
  static const std::string compressed_document = compressed(api::openapi_document(), api::Effort::most);
  Response response = Response::json(200, api::openapi_document());
  response.compressed = &compressed_document;
  return response;
}

}  // namespace signorini::server
