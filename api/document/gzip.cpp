#include "api/document/gzip.hpp"

#include <array>
#include <new>

#define ZLIB_CONST  // input that stays as it is
#include <zlib.h>

namespace signorini::api {

/// zlib's state and the room that it writes to.
class Gzip::Deflate {
 public:
  explicit Deflate(Effort effort) {
    constexpr int gzip_with_largest_window = 16 + MAX_WBITS, usual_memory = 8;
    const int level = effort == Effort::least ? Z_BEST_SPEED : Z_BEST_COMPRESSION;
    if (deflateInit2(&stream_, level, Z_DEFLATED, gzip_with_largest_window, usual_memory,
                     Z_DEFAULT_STRATEGY) != Z_OK)
      throw std::bad_alloc();
  }
  ~Deflate() { deflateEnd(&stream_); }

  Deflate(const Deflate&) = delete;
  Deflate& operator=(const Deflate&) = delete;

  bool put(std::string_view piece, int flush, const Sink& sink) {
    stream_.next_in = reinterpret_cast<const Bytef*>(piece.data());
    stream_.avail_in = static_cast<uInt>(piece.size());
    do {
      stream_.next_out = reinterpret_cast<Bytef*>(out_.data());
      stream_.avail_out = static_cast<uInt>(out_.size());
      deflate(&stream_, flush);
      const std::size_t written = out_.size() - stream_.avail_out;
      if (written > 0 && !sink({out_.data(), written})) return false;
    } while (stream_.avail_out == 0);
    return true;
  }

 private:
  z_stream stream_{};
  std::array<char, 32 * 1024> out_;
};

Gzip::Gzip(const Sink& sink, Effort effort) : sink_(sink), deflate_(std::make_unique<Deflate>(effort)) {}

Gzip::~Gzip() = default;

bool Gzip::put(std::string_view piece) {
  return deflate_->put(piece, Z_NO_FLUSH, sink_);
}

bool Gzip::finish() {
  return deflate_->put({}, Z_FINISH, sink_);
}

namespace {

/// zlib's state.
class Inflate {
 public:
  explicit Inflate(Coding coding) {
    if (inflateInit2(&stream, coding == Coding::gzip ? 16 + MAX_WBITS : MAX_WBITS) != Z_OK)
      throw std::bad_alloc();
  }
  ~Inflate() { inflateEnd(&stream); }

  Inflate(const Inflate&) = delete;
  Inflate& operator=(const Inflate&) = delete;

  z_stream stream{};
};

}  // namespace

Inflation inflate(std::string_view bytes, Coding coding, std::size_t longest, std::string& text) {
  Inflate state(coding);
  z_stream& stream = state.stream;
  stream.next_in = reinterpret_cast<const Bytef*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::array<char, 32 * 1024> out;
  for (;;) {
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    const int status = ::inflate(&stream, Z_NO_FLUSH);
    const std::size_t written = out.size() - stream.avail_out;
    if (written > longest - text.size()) return Inflation::too_long;
    text.append(out.data(), written);
    if (status == Z_STREAM_END && stream.avail_in == 0) return Inflation::whole;
    const bool next_member =
        status == Z_STREAM_END && coding == Coding::gzip && inflateReset(&stream) == Z_OK;
    if (status != Z_OK && !next_member) return Inflation::broken;
  }
}

}  // namespace signorini::api
