#pragma once

#include <memory>

#include "api/piece_writer.hpp"

namespace signorini::api {

/// Compresses a document on its way to a sink, as one gzip member (RFC 1952) at zlib's fastest level: results
/// are written faster than they can be compressed well. Takes about 300 KiB, however long the document is.
class Gzip {
 public:
  /// The sink must outlive the object.
  explicit Gzip(const Sink& sink);
  ~Gzip();

  Gzip(const Gzip&) = delete;
  Gzip& operator=(const Gzip&) = delete;

  /// Takes the next piece; false if the sink takes no more.
  bool put(std::string_view piece);

  /// Writes what is left; to be called once, after the last piece. False if the sink takes no more.
  bool finish();

 private:
  class Deflate;

  const Sink& sink_;
  std::unique_ptr<Deflate> deflate_;
};

}  // namespace signorini::api
