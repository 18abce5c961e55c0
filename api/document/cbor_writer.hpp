#pragma once

#include "api/document/document_writer.hpp"

namespace signorini::api {

/// Writes one CBOR document. Maps and arrays have indefinite length (their sizes are not known before they
/// are written), arrays of numbers a definite one: they are RFC 8746 typed arrays, little endian float64 (tag
/// 86) or sint32 (tag 78), and if they have several extents, within a row-major multi-dimensional array (tag
/// 40). A number alone is a float64 or an integer, whatever its value.
class CborWriter final : public DocumentWriter {
 public:
  explicit CborWriter(PieceWriter& out) : out_(out) {}

  CborWriter& begin_object() override { return put_byte(0xbf); }
  CborWriter& end_object() override { return put_byte(0xff); }
  CborWriter& begin_array() override { return put_byte(0x9f); }
  CborWriter& end_array() override { return put_byte(0xff); }
  CborWriter& key(std::string_view name) override { return put(name); }
  CborWriter& null() override { return put_byte(0xf6); }
  CborWriter& json(std::string_view text) override;

 private:
  /// The kinds of data items that a head tells (RFC 8949, 3.1).
  enum class Major : unsigned { integer, negative, bytes, text, array, map, tag };

  CborWriter& put(double number) override;
  CborWriter& put(std::int64_t number) override;
  CborWriter& put(bool truth) override { return put_byte(truth ? 0xf5 : 0xf4); }
  CborWriter& put(std::string_view text) override;

  void begin_numbers(const Shape& shape, double) override;
  void begin_numbers(const Shape& shape, std::int32_t) override;
  void put_rows(std::span<const double> numbers) override;
  void put_rows(std::span<const std::int32_t> numbers) override;
  CborWriter& end_numbers() override { return *this; }

  CborWriter& put_byte(unsigned byte);
  /// The last so many bytes of the number, the most significant first.
  CborWriter& put_bytes(std::uint64_t number, int count);
  /// The kind of an item and its argument, in the fewest bytes.
  CborWriter& put_head(Major major, std::uint64_t argument);
  void begin_typed(const Shape& shape, std::uint64_t tag, std::size_t bytes_of_number);

  PieceWriter& out_;
};

}  // namespace signorini::api
