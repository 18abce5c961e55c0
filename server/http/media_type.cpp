#include "server/http/media_type.hpp"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "server/http/field_value.hpp"

namespace signorini::server {
namespace {

/// One element of an Accept or Accept-Encoding list; the weight is 1 unless it says `q=`.
struct Weighted {
  std::string name;
  double weight = 1;
};

std::vector<Weighted> weighted_list(std::string_view header) {
  std::vector<Weighted> list;
  const std::string small = lower(header);
  for (const std::string_view element : parts_of(small, ',')) {
    const std::vector<std::string_view> parts = parts_of(element, ';');
    if (parts.front().empty()) continue;
    Weighted weighted{std::string(parts.front())};
    for (std::size_t i = 1; i < parts.size(); ++i) {
      if (parts[i].starts_with("q="))
        weighted.weight = std::strtod(std::string(parts[i].substr(2)).c_str(), nullptr);
    }
    list.push_back(weighted);
  }
  return list;
}

/// 3 for the type itself, 2 for `type/*`, 1 for `*/*`, 0 for no match.
int specificity(const std::string& range, const std::string& media_type) {
  if (range == media_type) return 3;
  if (range == media_type.substr(0, media_type.find('/')) + "/*") return 2;
  return range == "*/*" ? 1 : 0;
}

/// What a client thinks of a media type; compares as it prefers.
struct Rank {
  double weight = 0;  ///< of the most specific range that holds the type; 0 if it is not taken
  int specificity = 0;

  auto operator<=>(const Rank&) const = default;
};

Rank rank_of(const std::string& media_type, const std::vector<Weighted>& ranges) {
  Rank rank;
  for (const Weighted& range : ranges) {
    const int found = specificity(range.name, media_type);
    if (found > rank.specificity) rank = {range.weight, found};
  }
  return rank;
}

std::optional<double> weight_of_coding(std::string_view coding, const std::vector<Weighted>& codings) {
  const auto found = std::find_if(codings.begin(), codings.end(),
                                  [&](const Weighted& element) { return element.name == coding; });
  return found == codings.end() ? std::nullopt : std::optional(found->weight);
}

/// Whether the media type is `application/` and the format, or a type that is written in it (RFC
/// 6838, 4.2.8).
bool is_application(std::string_view content_type, const std::string& format) {
  const std::string essence = lower(parts_of(content_type, ';').front());
  return essence == "application/" + format ||
         (essence.starts_with("application/") && essence.ends_with("+" + format));
}

}  // namespace

bool is_json(std::string_view content_type) {
  return is_application(content_type, "json");
}

bool is_cbor(std::string_view content_type) {
  return is_application(content_type, "cbor");
}

std::optional<std::string> preferred(const std::optional<std::string>& accept,
                                     const std::vector<std::string>& media_types) {
  const std::vector<Weighted> ranges = weighted_list(accept.value_or(""));
  if (ranges.empty()) return media_types.front();
  std::optional<std::string> best;
  Rank best_rank;
  for (const std::string& media_type : media_types) {
    const Rank rank = rank_of(media_type, ranges);
    if (rank.weight > 0 && rank > best_rank) {
      best = media_type;
      best_rank = rank;
    }
  }
  return best;
}

bool accepts_coding(std::string_view accept_encoding, std::string_view coding) {
  std::vector<Weighted> codings = weighted_list(accept_encoding);
  // RFC 9110, 8.4.1.3.
  for (Weighted& each : codings)
    if (each.name == "x-gzip") each.name = "gzip";
  const double weight =
      weight_of_coding(coding, codings).value_or(weight_of_coding("*", codings).value_or(0));
  return weight > 0 && weight >= weight_of_coding("identity", codings).value_or(0);
}

}  // namespace signorini::server
