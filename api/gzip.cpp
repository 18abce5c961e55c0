#include "api/gzip.hpp"

#include <array>
#include <new>

#define ZLIB_CONST  // input that stays as it is
#include <zlib.h>

namespace signorini::api {

/// zlib's state and the room that it writes to.
class Gzip::Deflate {
 public:
  Deflate() {
    constexpr int gzip_with_largest_window = 16 + MAX_WBITS, usual_memory = 8;
    if (deflateInit2(&stream_, Z_BEST_SPEED, Z_DEFLATED, gzip_with_largest_window, usual_memory,
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

Gzip::Gzip(const Sink& sink) : sink_(sink), deflate_(std::make_unique<Deflate>()) {}

Gzip::~Gzip() = default;

bool Gzip::put(std::string_view piece) {
  return deflate_->put(piece, Z_NO_FLUSH, sink_);
}

bool Gzip::finish() {
  return deflate_->put({}, Z_FINISH, sink_);
}

}  // namespace signorini::api
