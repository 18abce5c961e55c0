#include "server/log.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

#include <spdlog/spdlog.h>

#include "server/jobs/job.hpp"
#include "server/json_text.hpp"
#include "server/standard_error.hpp"

namespace signorini::server {
namespace {

using nlohmann::ordered_json;

struct Field {
  std::string_view name;
  ordered_json value;
};

thread_local std::vector<Field> fields;

/// What no line may show.
class Secrets {
 public:
  void add(const std::vector<std::string>& texts) {
    const std::lock_guard lock(mutex_);
    texts_.insert(texts.begin(), texts.end());
  }

  void take_out_of(std::string& text) const {
    const std::lock_guard lock(mutex_);
    for (const std::string& secret : texts_)
      for (std::size_t at = 0; (at = text.find(secret, at)) != std::string::npos;)
        text.replace(at, secret.size(), "***");
  }

 private:
  mutable std::mutex mutex_;
  std::set<std::string> texts_;
};

Secrets& secrets() {
  static Secrets all;
  return all;
}

/// Calls `visit(field)` for every field that no later one hides.
template <typename Visit>
void for_each_field(const Visit& visit) {
  for (auto field = fields.begin(); field != fields.end(); ++field)
    if (std::find_if(field + 1, fields.end(),
                     [&](const Field& other) { return other.name == field->name; }) == fields.end())
      visit(*field);
}

std::string_view view(const spdlog::string_view_t& text) {
  return {text.data(), text.size()};
}

class TextLines : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
    std::string text = iso8601(message.time) + ' ';
    text.append(view(spdlog::level::to_string_view(message.level))).append(" ");
    for_each_field([&](const Field& field) {
      const bool is_text = field.value.is_string();
      text.append(field.name).append("=");
      text.append(is_text ? field.value.get_ref<const std::string&>() : field.value.dump()).append(" ");
    });
    text.append(view(message.payload)).append("\n");
    line.append(text.data(), text.data() + text.size());
  }

  std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<TextLines>(); }
};

class JsonLines : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
    ordered_json object{{"time", iso8601(message.time)},
                        {"level", view(spdlog::level::to_string_view(message.level))},
                        {"message", view(message.payload)}};
    for_each_field([&](const Field& field) { object[std::string(field.name)] = field.value; });
    const std::string text = json_text(object) + '\n';
    line.append(text.data(), text.data() + text.size());
  }

  std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<JsonLines>(); }
};

std::unique_ptr<spdlog::formatter> formatter(const std::string& format) {
  if (format == "json") return std::make_unique<JsonLines>();
  return std::make_unique<TextLines>();
}

}  // namespace

void start_log(const std::string& level, const std::string& format) {
  const auto logger = std::make_shared<spdlog::logger>("signorinid", std::make_shared<StandardError>());
  logger->set_formatter(formatter(format));
  logger->set_level(spdlog::level::from_str(level));
  spdlog::set_default_logger(logger);
}

void hide_in_log(const std::vector<std::string>& texts) {
  secrets().add(texts);
}

std::string without_secrets(std::string text) {
  secrets().take_out_of(text);
  return text;
}

LogField::LogField(std::string_view name, std::string text) {
  fields.push_back({name, without_secrets(std::move(text))});
}

LogField::LogField(std::string_view name, std::int64_t number) {
  fields.push_back({name, number});
}

LogField::LogField(std::string_view name, double number) {
  fields.push_back({name, number});
}

LogField::~LogField() {
  fields.pop_back();
}

}  // namespace signorini::server
