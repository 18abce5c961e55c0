#pragma once

#include <string>
#include <vector>

#include <prometheus/metric_family.h>

namespace signorini::server {

/// A value of a family, with at most one label.
struct Sample {
  double value = 0;
  std::string label = {}, label_value = {};
};

/// Values that are known at the moment they are asked for.
prometheus::MetricFamily gauge(std::string name, std::string help, const std::vector<Sample>& samples);
prometheus::MetricFamily counter(std::string name, std::string help, const std::vector<Sample>& samples);

/// Memory, processor time, threads and file descriptors of this process, under the names that Prometheus's
/// clients have agreed on.
std::vector<prometheus::MetricFamily> process_families();

}  // namespace signorini::server
