#pragma once

#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <type_traits>

namespace signorini::api {

/// Takes the next piece of a document; false means that nobody reads any more.
using Sink = std::function<bool(std::string_view piece)>;

/// Thrown out of a writer whose sink takes no more.
struct SinkClosed {};

/// Gathers the bytes of one document and gives them to a sink in pieces of at most 64 KiB; the document as
/// a whole is never in memory.
class PieceWriter {
 public:
  static constexpr std::size_t piece_size = std::size_t{64} * 1024;

  /// The sink must outlive the writer.
  explicit PieceWriter(const Sink& sink)
      : sink_(sink), piece_(std::make_unique_for_overwrite<char[]>(piece_size + longest_number)) {}

  void put(std::string_view bytes);
  void put(char byte) {
    piece_[size_++] = byte;
    give_if_full();
  }

  /// The shortest digits that are read back as the same number. Throws std::logic_error if it is not
  /// finite: JSON has no such numbers, and no result holds one.
  template <typename Number>
  void put_digits(Number number) {
    require_finite(number);
    char* const begin = piece_.get() + size_;
    size_ += static_cast<std::size_t>(std::to_chars(begin, begin + longest_number, number).ptr - begin);
    give_if_full();
  }

  /// The bytes of the number, the least significant first. Throws as put_digits().
  template <typename Number>
  void put_binary(Number number) {
    require_finite(number);
    using Bits = std::conditional_t<sizeof(Number) == 8, std::uint64_t, std::uint32_t>;
    const auto bits = std::bit_cast<Bits>(number);
    for (std::size_t byte = 0; byte < sizeof bits; ++byte)
      piece_[size_ + byte] = static_cast<char>(bits >> (8 * byte));
    size_ += sizeof bits;
    give_if_full();
  }

  /// Gives what is gathered to the sink. Throws SinkClosed if that takes no more.
  void flush();

 private:
  /// The room behind a piece, so that a number never has to be cut.
  static constexpr std::size_t longest_number = 32;

  template <typename Number>
  static void require_finite(Number number) {
    if constexpr (std::is_floating_point_v<Number>)
      if (!std::isfinite(number)) throw std::logic_error("a result holds a number that is not finite");
  }

  void give_if_full() {
    if (size_ >= piece_size) give_piece();
  }

  /// Gives a whole piece; what goes beyond it begins the next.
  void give_piece();

  const Sink& sink_;
  std::unique_ptr<char[]> piece_;
  std::size_t size_ = 0;
};

/// Runs a writer to its end; false if the sink ended it.
template <typename Write>
bool write_all(const Sink& sink, const Write& write) {
  PieceWriter out(sink);
  try {
    write(out);
    out.flush();
  } catch (const SinkClosed&) {
    return false;
  }
  return true;
}

}  // namespace signorini::api
