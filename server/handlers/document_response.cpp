#include "server/handlers/document_response.hpp"

namespace signorini::server {

Response document_response(const Request& request, int status, api::WriteDocument write) {
  const bool cbor = request.reply_type == "application/cbor";
  Response response = Response::empty(status);
  response.content_type = request.reply_type;
  response.write_body = [format = cbor ? api::Format::cbor : api::Format::json, write = std::move(write)](
                            const PieceSink& sink) { return api::write_document(format, sink, write); };
  return response;
}

}  // namespace signorini::server
