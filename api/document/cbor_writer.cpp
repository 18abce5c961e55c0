#include "api/document/cbor_writer.hpp"

#include <bit>
#include <functional>
#include <limits>
#include <numeric>

#include <nlohmann/json.hpp>

namespace signorini::api {
namespace {

constexpr std::uint64_t row_major_tag = 40, int32_tag = 78, float64_tag = 86;

/// Turns the events of a JSON parser into calls of a writer.
class JsonToCbor : public nlohmann::json_sax<nlohmann::json> {
 public:
  explicit JsonToCbor(DocumentWriter& out) : out_(out) {}

  bool null() override { return out_.null(), true; }
  bool boolean(bool truth) override { return out_.value(truth), true; }
  bool number_integer(number_integer_t number) override { return out_.value(number), true; }
  bool number_unsigned(number_unsigned_t number) override {
    constexpr auto largest = static_cast<number_unsigned_t>(std::numeric_limits<std::int64_t>::max());
    number <= largest ? out_.value(number) : out_.value(static_cast<double>(number));
    return true;
  }
  bool number_float(number_float_t number, const string_t&) override { return out_.value(number), true; }
  bool string(string_t& text) override { return out_.value(text), true; }
  bool binary(binary_t&) override { return false; }  // JSON text has none
  bool start_object(std::size_t) override { return out_.begin_object(), true; }
  bool key(string_t& name) override { return out_.key(name), true; }
  bool end_object() override { return out_.end_object(), true; }
  bool start_array(std::size_t) override { return out_.begin_array(), true; }
  bool end_array() override { return out_.end_array(), true; }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& error) override {
    throw std::logic_error(std::string("a document holds a text that is no JSON: ") + error.what());
  }

 private:
  DocumentWriter& out_;
};

}  // namespace

CborWriter& CborWriter::json(std::string_view text) {
  JsonToCbor transcription(*this);
  nlohmann::json::sax_parse(text, &transcription);
  return *this;
}

CborWriter& CborWriter::put(double number) {
  if (!std::isfinite(number)) throw std::logic_error("a result holds a number that is not finite");
  return put_byte(0xfb).put_bytes(std::bit_cast<std::uint64_t>(number), 8);
}

CborWriter& CborWriter::put(std::int64_t number) {
  if (number >= 0) return put_head(Major::integer, static_cast<std::uint64_t>(number));
  return put_head(Major::negative, static_cast<std::uint64_t>(-1 - number));
}

CborWriter& CborWriter::put(std::string_view text) {
  put_head(Major::text, text.size());
  out_.put(text);
  return *this;
}

void CborWriter::begin_numbers(const Shape& shape, double) {
  begin_typed(shape, float64_tag, sizeof(double));
}

void CborWriter::begin_numbers(const Shape& shape, std::int32_t) {
  begin_typed(shape, int32_tag, sizeof(std::int32_t));
}

void CborWriter::begin_typed(const Shape& shape, std::uint64_t tag, std::size_t bytes_of_number) {
  if (shape.size() > 1) {
    put_head(Major::tag, row_major_tag);
    put_head(Major::array, 2);
    put_head(Major::array, shape.size());
    for (const std::size_t extent : shape) put_head(Major::integer, extent);
  }
  put_head(Major::tag, tag);
  put_head(Major::bytes, std::accumulate(shape.begin(), shape.end(), bytes_of_number, std::multiplies<>()));
}

void CborWriter::put_rows(std::span<const double> numbers) {
  for (const double number : numbers) out_.put_binary(number);
}

void CborWriter::put_rows(std::span<const std::int32_t> numbers) {
  for (const std::int32_t number : numbers) out_.put_binary(number);
}

CborWriter& CborWriter::put_byte(unsigned byte) {
  out_.put(static_cast<char>(byte));
  return *this;
}

CborWriter& CborWriter::put_bytes(std::uint64_t number, int count) {
  while (count-- > 0) put_byte(static_cast<unsigned>(number >> (8 * count) & 0xff));
  return *this;
}

CborWriter& CborWriter::put_head(Major major, std::uint64_t argument) {
  const unsigned initial = static_cast<unsigned>(major) << 5;
  if (argument < 24) return put_byte(initial | static_cast<unsigned>(argument));
  const unsigned power = argument <= 0xff ? 0 : argument <= 0xffff ? 1 : argument <= 0xffffffff ? 2 : 3;
  return put_byte(initial | (24 + power)).put_bytes(argument, 1 << power);
}

}  // namespace signorini::api
