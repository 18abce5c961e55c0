#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace signorini::server {

/// One line an event on standard error, in UTC, from this level on. `format` is `text` (time, level, fields
/// as name=value, message) or `json` (an object a line: `time`, `level`, `message`, the fields). Nobody waits
/// for who reads them: what is not read in time is lost, and a line says how much.
void start_log(const std::string& level, const std::string& format = "text");

/// From now on no field of a line shows one of these texts, whoever has put it there: asterisks stand in its
/// place.
void hide_in_log(const std::vector<std::string>& texts);

/// The text as a line may show it.
std::string without_secrets(std::string text);

/// A field of every line that this thread writes while the object lives, such as the job that it works on. Of
/// two with the same name the later one counts. Objects must end in the reverse order of their making.
class LogField {
 public:
  LogField(std::string_view name, std::string text);
  LogField(std::string_view name, std::int64_t number);
  LogField(std::string_view name, double number);
  ~LogField();

  LogField(const LogField&) = delete;
  LogField& operator=(const LogField&) = delete;
};

}  // namespace signorini::server
