#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "api/document/piece_writer.hpp"

namespace signorini::api {

/// The extents of an array of numbers, the outermost first: {triangles, 3, 2} is three pairs a triangle.
using Shape = std::vector<std::size_t>;

/// Writes one document, in a format that the caller need not know. The caller opens and closes in the right
/// order; a value stands in an array or behind a key, or is the document.
class DocumentWriter {
 public:
  virtual ~DocumentWriter() = default;

  virtual DocumentWriter& begin_object() = 0;
  virtual DocumentWriter& end_object() = 0;
  virtual DocumentWriter& begin_array() = 0;
  virtual DocumentWriter& end_array() = 0;

  /// The name of the next value, inside an object.
  virtual DocumentWriter& key(std::string_view name) = 0;

  /// Finite; it is read back as the same number.
  DocumentWriter& value(double number) { return put(number); }
  template <std::integral Integer>
  DocumentWriter& value(Integer number) {
    return put(static_cast<std::int64_t>(number));
  }
  DocumentWriter& value(bool truth) { return put(truth); }
  DocumentWriter& value(std::string_view text) { return put(text); }
  DocumentWriter& value(const char* text) { return put(std::string_view(text)); }
  virtual DocumentWriter& null() = 0;

  /// A value that stands in a JSON text.
  virtual DocumentWriter& json(std::string_view text) = 0;

  template <typename Value>
  DocumentWriter& member(std::string_view name, const Value& of_member) {
    return key(name).value(of_member);
  }

  /// An array of texts.
  DocumentWriter& texts(const std::vector<std::string>& all) {
    begin_array();
    for (const std::string& text : all) value(text);
    return end_array();
  }

  /// An array of this shape, its numbers row by row. Throws std::logic_error for one that is not finite.
  template <typename Number>
  DocumentWriter& numbers(const Shape& shape, std::span<const Number> all) {
    begin_numbers(shape, Number{});
    put_rows(all);
    return end_numbers();
  }

  /// The same, each row computed when it is written: `row(i)` is a contiguous range of the numbers of row i,
  /// or the one number.
  template <typename RowOf>
  DocumentWriter& rows(const Shape& shape, const RowOf& row) {
    using Row = std::decay_t<decltype(row(std::size_t{0}))>;
    if constexpr (std::is_arithmetic_v<Row>) {
      return rows(shape, [&](std::size_t i) { return std::array<Row, 1>{row(i)}; });
    } else {
      using Number = std::decay_t<decltype(*row(std::size_t{0}).data())>;
      begin_numbers(shape, Number{});
      for (std::size_t i = 0; i < shape.front(); ++i) {
        const auto numbers_of_row = row(i);
        put_rows(
            std::span<const Number>(numbers_of_row.data(), static_cast<std::size_t>(numbers_of_row.size())));
      }
      return end_numbers();
    }
  }

 private:
  virtual DocumentWriter& put(double number) = 0;
  virtual DocumentWriter& put(std::int64_t number) = 0;
  virtual DocumentWriter& put(bool truth) = 0;
  virtual DocumentWriter& put(std::string_view text) = 0;

  /// The second argument tells the type of the numbers.
  virtual void begin_numbers(const Shape& shape, double) = 0;
  virtual void begin_numbers(const Shape& shape, std::int32_t) = 0;
  /// Any number of whole rows.
  virtual void put_rows(std::span<const double> numbers) = 0;
  virtual void put_rows(std::span<const std::int32_t> numbers) = 0;
  virtual DocumentWriter& end_numbers() = 0;
};

/// The formats of a document: JSON (RFC 8259), and CBOR (RFC 8949) with typed arrays (RFC 8746).
enum class Format { json, cbor };

/// Writes a document to a writer.
using WriteDocument = std::function<void(DocumentWriter& out)>;

/// Writes a document in the format, in pieces of at most PieceWriter::piece_size; false if the sink ended it.
bool write_document(Format format, const Sink& sink, const WriteDocument& write);

}  // namespace signorini::api
