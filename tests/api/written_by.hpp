#pragma once

#include <string>

#include <gtest/gtest.h>

#include "api/document/document_writer.hpp"

namespace signorini::api {

/// All that `write(sink)` writes.
template <typename Write>
std::string written_by(const Write& write) {
  std::string text;
  EXPECT_TRUE(write([&](std::string_view piece) {
    EXPECT_LE(piece.size(), PieceWriter::piece_size);
    text += piece;
    return true;
  }));
  return text;
}

/// The document that `write` writes, as text.
inline std::string text_of(const WriteDocument& write, Format format = Format::json) {
  return written_by([&](const Sink& sink) { return write_document(format, sink, write); });
}

}  // namespace signorini::api
