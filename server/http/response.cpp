#include "server/http/response.hpp"

namespace signorini::server {

Response Response::json(int status, std::string text) {
  Response response = empty(status);
  response.content_type = "application/json";
  response.body = std::move(text);
  return response;
}

Response Response::empty(int status) {
  Response response;
  response.status = status;
  return response;
}

}  // namespace signorini::server
