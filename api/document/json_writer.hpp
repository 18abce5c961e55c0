#pragma once

#include "api/document/document_writer.hpp"

namespace signorini::api {

/// Writes one JSON document and sets its commas.
class JsonWriter final : public DocumentWriter {
 public:
  explicit JsonWriter(PieceWriter& out) : out_(out) {}

  JsonWriter& begin_object() override { return open('{'); }
  JsonWriter& end_object() override { return close('}'); }
  JsonWriter& begin_array() override { return open('['); }
  JsonWriter& end_array() override { return close(']'); }
  JsonWriter& key(std::string_view name) override;
  JsonWriter& null() override { return json("null"); }
  JsonWriter& json(std::string_view text) override;

 private:
  /// By PieceWriter::put_digits.
  JsonWriter& put(double number) override;
  JsonWriter& put(std::int64_t number) override;
  JsonWriter& put(bool truth) override { return json(truth ? "true" : "false"); }
  JsonWriter& put(std::string_view text) override;

  void begin_numbers(const Shape& shape, double) override { begin_numbers(shape); }
  void begin_numbers(const Shape& shape, std::int32_t) override { begin_numbers(shape); }
  void begin_numbers(const Shape& shape);
  void put_rows(std::span<const double> numbers) override;
  void put_rows(std::span<const std::int32_t> numbers) override;
  JsonWriter& end_numbers() override { return close(']'); }

  JsonWriter& open(char bracket);
  JsonWriter& close(char bracket);
  void separate();
  void put_string(std::string_view text);

  PieceWriter& out_;
  bool follows_ = false;  ///< a value stands before this place in the same container
  Shape row_;             ///< of the array of numbers that is being written
};

}  // namespace signorini::api
