// A service's status as Prometheus metrics: names, units and kinds.
//
// Prometheus, "Metric and label naming" and "Writing exporters" (prometheus.io/docs/practices):
// base units in the names, totals end in _total, one metric with a label for its variants.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "topogeo/msg/status.h"

namespace topogeo::service {

enum class MetricKind : std::uint8_t {
  kTotal,  ///< only grows while the service runs
  kGauge
};

/// The metric for a counter of the status.
struct CounterMetric {
  /// Name of the counter. A `*` at the end matches all counters with that prefix; the rest of their
  /// name is the value of the label.
  std::string_view counter;
  std::string_view metric;
  MetricKind kind = MetricKind::kGauge;
  std::string_view help;
  std::string_view label = {};  ///< without a `*`: "label=value", or empty
  double factor = 1.0;          ///< from the counter's unit to the unit of the metric
};

struct MetricSample {
  std::vector<std::pair<std::string, std::string>> labels;
  double value = 0.0;
};

struct MetricFamily {
  std::string name;
  std::string help;
  MetricKind kind = MetricKind::kGauge;
  std::vector<MetricSample> samples;
};

/// Every counter that services have in their status.
std::span<const CounterMetric> counter_metrics();

/// The declaration of a counter, or nullptr.
const CounterMetric* find_metric(std::string_view counter);

/// The metrics of a status in the order of their declaration, each with the labels service, robot
/// and host. Counters that are not declared are left out.
std::vector<MetricFamily> metrics_of(const msg::ServiceStatus& status);

/// The names of all metrics that there can be.
std::vector<std::string> metric_names();

}  // namespace topogeo::service
