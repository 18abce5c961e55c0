#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "api/document/piece_writer.hpp"

namespace signorini::api {

/// `least`: results are written faster than they can be compressed well; `most`: for what is compressed once.
enum class Effort { least, most };

/// Compresses a document on its way to a sink, as one gzip member (RFC 1952). Takes about 300 KiB, however
/// long the document is.
class Gzip {
 public:
  /// The sink must outlive the object.
  explicit Gzip(const Sink& sink, Effort effort = Effort::least);
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

enum class Coding { gzip, zlib };  ///< RFC 1952, RFC 1950
enum class Inflation { whole, too_long, broken };

/// Decompresses a text whose end must be there, of at most `longest` bytes; gzip may have several members.
/// The text says nothing unless it is whole.
Inflation inflate(std::string_view bytes, Coding coding, std::size_t longest, std::string& text);

}  // namespace signorini::api
