#include "api/document/json_writer.hpp"

#include <functional>
#include <numeric>
#include <string>

namespace signorini::api {
namespace {

/// How a character stands in a JSON string if it may not stand there as it is, else nothing.
std::string escape(char c) {
  switch (c) {
    case '"':
      return "\\\"";
    case '\\':
      return "\\\\";
    case '\n':
      return "\\n";
    case '\r':
      return "\\r";
    case '\t':
      return "\\t";
    default:
      break;
  }
  const auto code = static_cast<unsigned char>(c);
  if (code >= 0x20) return {};
  constexpr std::string_view digits = "0123456789abcdef";
  return std::string("\\u00") + digits[code / 16] + digits[code % 16];
}

/// The numbers of one array of the shape (the extents inside it follow), or one number if there is none.
template <typename Number>
void put_block(PieceWriter& out, std::span<const Number> numbers, std::span<const std::size_t> shape) {
  if (shape.empty()) {
    out.put_digits(numbers.front());
    return;
  }
  const std::size_t step = numbers.size() / shape.front();
  out.put('[');
  for (std::size_t i = 0; i < shape.front(); ++i) {
    if (i > 0) out.put(',');
    put_block(out, numbers.subspan(i * step, step), shape.subspan(1));
  }
  out.put(']');
}

template <typename Number>
void put_blocks(PieceWriter& out, std::span<const Number> numbers, const Shape& shape, bool& follows) {
  const std::size_t step = std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
  for (std::size_t i = 0; i < numbers.size(); i += step) {
    if (follows) out.put(',');
    follows = true;
    put_block(out, numbers.subspan(i, step), std::span<const std::size_t>(shape));
  }
}

}  // namespace

JsonWriter& JsonWriter::key(std::string_view name) {
  separate();
  put_string(name);
  out_.put(':');
  follows_ = false;
  return *this;
}

JsonWriter& JsonWriter::json(std::string_view text) {
  separate();
  out_.put(text);
  follows_ = true;
  return *this;
}

JsonWriter& JsonWriter::put(double number) {
  separate();
  out_.put_digits(number);
  follows_ = true;
  return *this;
}

JsonWriter& JsonWriter::put(std::int64_t number) {
  separate();
  out_.put_digits(number);
  follows_ = true;
  return *this;
}

JsonWriter& JsonWriter::put(std::string_view text) {
  separate();
  put_string(text);
  follows_ = true;
  return *this;
}

void JsonWriter::begin_numbers(const Shape& shape) {
  row_.assign(shape.begin() + 1, shape.end());
  open('[');
}

void JsonWriter::put_rows(std::span<const double> numbers) {
  put_blocks(out_, numbers, row_, follows_);
}

void JsonWriter::put_rows(std::span<const std::int32_t> numbers) {
  put_blocks(out_, numbers, row_, follows_);
}

JsonWriter& JsonWriter::open(char bracket) {
  separate();
  out_.put(bracket);
  follows_ = false;
  return *this;
}

JsonWriter& JsonWriter::close(char bracket) {
  out_.put(bracket);
  follows_ = true;
  return *this;
}

void JsonWriter::separate() {
  if (follows_) out_.put(',');
}

void JsonWriter::put_string(std::string_view text) {
  out_.put('"');
  std::size_t written = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string escaped = escape(text[i]);
    if (escaped.empty()) continue;
    out_.put(text.substr(written, i - written));
    out_.put(escaped);
    written = i + 1;
  }
  out_.put(text.substr(written));
  out_.put('"');
}

}  // namespace signorini::api
