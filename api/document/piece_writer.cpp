#include "api/document/piece_writer.hpp"

#include <cstring>

namespace signorini::api {

void PieceWriter::put(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::string_view fits = bytes.substr(0, piece_size - size_);
    std::memcpy(piece_.get() + size_, fits.data(), fits.size());
    size_ += fits.size();
    bytes.remove_prefix(fits.size());
    give_if_full();
  }
}

void PieceWriter::flush() {
  if (size_ > 0 && !sink_({piece_.get(), size_})) throw SinkClosed();
  size_ = 0;
}

void PieceWriter::give_piece() {
  if (!sink_({piece_.get(), piece_size})) throw SinkClosed();
  size_ -= piece_size;
  std::memcpy(piece_.get(), piece_.get() + piece_size, size_);
}

}  // namespace signorini::api
