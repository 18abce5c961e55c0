#include "api/document/cbor_document.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <cbor.h>

#include "api/document/json_writer.hpp"
#include "api/document/typed_array.hpp"
#include "api/limits.hpp"

namespace signorini::api {
namespace {

enum class Kind { none, positive, negative, real, boolean, null, text, bytes, array, map, tag, end, other };

/// One head of the document, with the bytes of a string.
struct Item {
  Kind kind = Kind::none;
  std::uint64_t number = 0;  ///< its value, its length or its tag; a negative integer is −1 − number
  bool has_length = true;
  double real = 0;
  std::string_view string;
};

/// What the library calls for each kind of item: it is kept, so that nothing is thrown through the library.
struct Callbacks : cbor_callbacks {
  Callbacks() : cbor_callbacks(cbor_empty_callbacks) {
    uint8 = [](void* item, std::uint8_t value) { set(item, Kind::positive, value); };
    uint16 = [](void* item, std::uint16_t value) { set(item, Kind::positive, value); };
    uint32 = [](void* item, std::uint32_t value) { set(item, Kind::positive, value); };
    uint64 = [](void* item, std::uint64_t value) { set(item, Kind::positive, value); };
    negint8 = [](void* item, std::uint8_t value) { set(item, Kind::negative, value); };
    negint16 = [](void* item, std::uint16_t value) { set(item, Kind::negative, value); };
    negint32 = [](void* item, std::uint32_t value) { set(item, Kind::negative, value); };
    negint64 = [](void* item, std::uint64_t value) { set(item, Kind::negative, value); };
    float2 = [](void* item, float value) { set_real(item, value); };
    float4 = [](void* item, float value) { set_real(item, value); };
    float8 = set_real;
    boolean = [](void* item, bool value) { set(item, Kind::boolean, value ? 1 : 0); };
    null = [](void* item) { set(item, Kind::null, 0); };
    undefined = [](void* item) { set(item, Kind::other, 0); };
    string = [](void* item, cbor_data data, std::size_t size) { set_string(item, Kind::text, data, size); };
    byte_string = [](void* item, cbor_data data, std::size_t size) {
      set_string(item, Kind::bytes, data, size);
    };
    string_start = byte_string_start = [](void* item) { set(item, Kind::other, 0); };
    array_start = [](void* item, std::size_t length) { set(item, Kind::array, length); };
    map_start = [](void* item, std::size_t length) { set(item, Kind::map, length); };
    indef_array_start = [](void* item) { set(item, Kind::array, 0, false); };
    indef_map_start = [](void* item) { set(item, Kind::map, 0, false); };
    indef_break = [](void* item) { set(item, Kind::end, 0); };
    tag = [](void* item, std::uint64_t value) { set(item, Kind::tag, value); };
  }

 private:
  static void set(void* item, Kind kind, std::uint64_t number, bool has_length = true) {
    *static_cast<Item*>(item) = {kind, number, has_length, 0, {}};
  }
  static void set_real(void* item, double value) {
    *static_cast<Item*>(item) = {Kind::real, 0, true, value, {}};
  }
  static void set_string(void* item, Kind kind, cbor_data data, std::size_t size) {
    *static_cast<Item*>(item) = {kind, size, true, 0, {reinterpret_cast<const char*>(data), size}};
  }
};

const Callbacks callbacks;

constexpr std::uint64_t row_major_array = 40;
constexpr std::uint64_t self_described = 55799;

/// Reads the document item by item and writes it again.
class CborTranscription {
 public:
  CborTranscription(std::string_view bytes, DocumentWriter& out) : bytes_(bytes), out_(out) {}

  void run() {
    Item first = next();
    if (first.kind == Kind::tag && first.number == self_described) first = next();
    write(first, 0);
    if (position_ != bytes_.size()) fail("the document ends here and more bytes follow");
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw MalformedCbor("the body cannot be read as CBOR: " + what + " (byte " + std::to_string(before_) +
                        ")");
  }

  Item next() {
    before_ = position_;
    Item item;
    const auto* data = reinterpret_cast<cbor_data>(bytes_.data()) + position_;
    const cbor_decoder_result result = cbor_stream_decode(data, bytes_.size() - position_, &callbacks, &item);
    if (result.status == CBOR_DECODER_NEDATA) fail("it ends too early");
    if (result.status != CBOR_DECODER_FINISHED || item.kind == Kind::none) fail("this byte begins no item");
    position_ += result.read;
    return item;
  }

  void write(const Item& item, std::size_t depth) {
    switch (item.kind) {
      case Kind::positive:
      case Kind::negative:
        return write_integer(item);
      case Kind::real:
        if (!std::isfinite(item.real)) fail("a number is not finite");
        out_.value(item.real);
        return;
      case Kind::boolean:
        out_.value(item.number != 0);
        return;
      case Kind::null:
        out_.null();
        return;
      case Kind::text:
        out_.value(item.string);
        return;
      case Kind::array:
        return write_array(item, depth + 1);
      case Kind::map:
        return write_map(item, depth + 1);
      case Kind::tag:
        return write_tagged(item.number);
      case Kind::bytes:
        fail("bytes stand only in typed arrays (RFC 8746), behind their tag");
      case Kind::end:
        fail("a break stands where a value is expected");
      default:
        fail("undefined and strings of indefinite length have no place in a problem");
    }
  }

  void write_integer(const Item& item) {
    constexpr auto most = static_cast<std::uint64_t>(INT64_MAX);
    const auto magnitude = static_cast<std::int64_t>(item.number);
    if (item.number > most)
      out_.value(item.kind == Kind::positive ? static_cast<double>(item.number)
                                             : -1 - static_cast<double>(item.number));
    else
      out_.value(item.kind == Kind::positive ? magnitude : -1 - magnitude);
  }

  /// Calls `read(item)` with each item that begins an element.
  template <typename Read>
  void for_each_element(const Item& container, const Read& read) {
    for (std::uint64_t i = 0; !container.has_length || i < container.number; ++i) {
      const Item item = next();
      if (!container.has_length && item.kind == Kind::end) return;
      read(item);
    }
  }

  void require_shallow(std::size_t depth) const {
    if (depth > limits::nesting)
      fail("arrays and maps are nested deeper than " + std::to_string(limits::nesting) + " levels");
  }

  void write_array(const Item& array, std::size_t depth) {
    require_shallow(depth);
    out_.begin_array();
    for_each_element(array, [&](const Item& item) { write(item, depth); });
    out_.end_array();
  }

  void write_map(const Item& map, std::size_t depth) {
    require_shallow(depth);
    out_.begin_object();
    for_each_element(map, [&](const Item& item) {
      if (item.kind != Kind::text) fail("the key of a map is no text");
      out_.key(item.string);
      write(next(), depth);
    });
    out_.end_object();
  }

  void write_tagged(std::uint64_t tag) {
    if (tag == row_major_array) return write_row_major();
    const TypedArray array = typed_array(tag);
    write_numbers(array, {array.size()});
  }

  TypedArray typed_array(std::uint64_t tag) {
    const std::optional<ElementType> type = element_type(tag);
    if (!type)
      fail("tag " + std::to_string(tag) +
           " has no meaning here; taken are those of typed arrays of at most 64 bits, and 40");
    const Item item = next();
    if (item.kind != Kind::bytes || item.string.size() % type->bytes != 0)
      fail("tag " + std::to_string(tag) + " stands before bytes, " + std::to_string(type->bytes) +
           " a number");
    return {*type, item.string};
  }

  void write_row_major() {
    const Item pair = next();
    if (pair.kind != Kind::array || pair.number != 2 || !pair.has_length)
      fail("tag 40 stands before an array of two, the extents and the numbers");
    const Shape shape = extents();
    const Item tag = next();
    if (tag.kind != Kind::tag) fail("the numbers within tag 40 must be a typed array");
    write_numbers(typed_array(tag.number), shape);
  }

  Shape extents() {
    const Item dimensions = next();
    constexpr std::size_t most = 8;
    if (dimensions.kind != Kind::array || !dimensions.has_length || dimensions.number == 0 ||
        dimensions.number > most)
      fail("the extents within tag 40 must be an array of 1 to " + std::to_string(most) + " numbers");
    Shape shape;
    for_each_element(dimensions, [&](const Item& item) {
      if (item.kind != Kind::positive || item.number == 0 || item.number > bytes_.size())
        fail("an extent must be a positive whole number, not larger than the array");
      shape.push_back(item.number);
    });
    return shape;
  }

  void write_numbers(const TypedArray& array, const Shape& shape) {
    std::size_t left = array.size();
    for (const std::size_t extent : shape) left = extent > 0 && left % extent == 0 ? left / extent : 0;
    if (array.size() > 0 ? left != 1 : shape != Shape{0})
      fail("the extents within tag 40 do not give the " + std::to_string(array.size()) +
           " numbers of the array");
    bool fits_int32 = !array.is_float();
    for (std::size_t i = 0; i < array.size(); ++i) {
      if (!std::isfinite(array[i])) fail("number " + std::to_string(i) + " of a typed array is not finite");
      fits_int32 = fits_int32 && array[i] >= INT32_MIN && array[i] <= INT32_MAX;
    }
    // Integers are written as such: 100000 and not 1e+05.
    fits_int32 ? write_rows<std::int32_t>(array, shape) : write_rows<double>(array, shape);
  }

  template <typename Number>
  void write_rows(const TypedArray& array, const Shape& shape) {
    const std::size_t width = array.size() / std::max<std::size_t>(shape.front(), 1);
    out_.rows(shape, [&](std::size_t row) {
      std::vector<Number> numbers(width);
      for (std::size_t i = 0; i < width; ++i) numbers[i] = static_cast<Number>(array[row * width + i]);
      return numbers;
    });
  }

  std::string_view bytes_;
  DocumentWriter& out_;
  std::size_t position_ = 0;
  std::size_t before_ = 0;  ///< where the last item begins
};

}  // namespace

std::optional<std::string> json_of_cbor(std::string_view bytes, std::size_t longest) {
  std::string text;
  const Sink sink = [&](std::string_view piece) {
    if (piece.size() > longest - text.size()) return false;
    text += piece;
    return true;
  };
  const bool fits =
      write_document(Format::json, sink, [&](DocumentWriter& out) { CborTranscription(bytes, out).run(); });
  return fits ? std::optional(std::move(text)) : std::nullopt;
}

}  // namespace signorini::api
