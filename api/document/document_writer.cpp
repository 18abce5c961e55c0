#include "api/document/document_writer.hpp"

#include "api/document/cbor_writer.hpp"
#include "api/document/json_writer.hpp"

namespace signorini::api {

bool write_document(Format format, const Sink& sink, const WriteDocument& write) {
  return write_all(sink, [&](PieceWriter& out) {
    if (format == Format::cbor) {
      CborWriter cbor(out);
      write(cbor);
    } else {
      JsonWriter json(out);
      write(json);
    }
  });
}

}  // namespace signorini::api
