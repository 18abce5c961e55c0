#include "server/metrics/families.hpp"

namespace signorini::server {
namespace {

using prometheus::ClientMetric;

prometheus::MetricFamily family(std::string name, std::string help, prometheus::MetricType type,
                                const std::vector<Sample>& samples) {
  prometheus::MetricFamily made{std::move(name), std::move(help), type, {}};
  for (const Sample& sample : samples) {
    ClientMetric& metric = made.metric.emplace_back();
    if (!sample.label.empty()) metric.label.push_back({sample.label, sample.label_value});
    metric.counter.value = metric.gauge.value = sample.value;
  }
  return made;
}

}  // namespace

prometheus::MetricFamily gauge(std::string name, std::string help, const std::vector<Sample>& samples) {
  return family(std::move(name), std::move(help), prometheus::MetricType::Gauge, samples);
}

prometheus::MetricFamily counter(std::string name, std::string help, const std::vector<Sample>& samples) {
  return family(std::move(name), std::move(help), prometheus::MetricType::Counter, samples);
}

}  // namespace signorini::server
