#include "topogeo/service/status_metrics.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <map>

#include "topogeo/support/format.hpp"

namespace topogeo::service {
namespace {

using Labels = std::vector<std::pair<std::string, std::string>>;
using Samples = std::vector<MetricSample>;

constexpr double kNano = 1e-9;

/// The metric for a field of the status.
struct FieldMetric {
  std::string_view metric;
  MetricKind kind;
  std::string_view help;
  Samples (*samples)(const msg::ServiceStatus& status);
};

Samples of_one(double value) {
  return {{{}, value}};
}

Samples of_reasons(const auto& counts) {
  Samples samples;
  for (const msg::FaultCount& count : counts) {
    samples.push_back(
        {{{"reason", count.reason().to_string()}}, static_cast<double>(count.count())});
  }
  return samples;
}

Samples of_states(const msg::ServiceStatus& status) {
  constexpr std::array<std::pair<msg::ServiceState, const char*>, 6> kStates = {
      {{msg::kServiceStarting, "starting"},
       {msg::kServiceWaiting, "waiting"},
       {msg::kServiceRunning, "running"},
       {msg::kServiceFinished, "finished"},
       {msg::kServiceFailed, "failed"},
       {msg::kServiceStopped, "stopped"}}};
  Samples samples;
  for (const auto& [state, name] : kStates) {
    samples.push_back({{{"state", name}}, state == status.state() ? 1.0 : 0.0});
  }
  return samples;
}

Samples of_traffic(const msg::ServiceStatus& status,
                   const std::function<double(const msg::TopicTraffic&)>& value) {
  Samples samples;
  for (const msg::TopicTraffic& one : status.traffic()) {
    samples.push_back(
        {{{"topic", one.topic().to_string()}, {"direction", one.sent() ? "sent" : "received"}},
         value(one)});
  }
  return samples;
}

Samples of_waiting(const msg::ServiceStatus& status) {
  Samples samples;
  for (const msg::TopicTraffic& one : status.traffic()) {
    if (one.sent()) continue;
    samples.push_back({{{"topic", one.topic().to_string()}}, static_cast<double>(one.waiting())});
  }
  return samples;
}

Samples of_queues(const msg::ServiceStatus& status, bool capacity) {
  Samples samples;
  for (const msg::QueueDepth& queue : status.queues()) {
    const std::uint64_t value = capacity ? queue.capacity() : queue.depth();
    if (capacity && value == 0) continue;
    samples.push_back({{{"queue", queue.name().to_string()}}, static_cast<double>(value)});
  }
  return samples;
}

using Status = msg::ServiceStatus;

constexpr auto kFieldMetrics = std::to_array<FieldMetric>({
    {"topogeo_service_info", MetricKind::kGauge, "1, with version and configuration as labels",
     [](const Status& s) -> Samples {
       return {{{{"version", s.version().to_string()},
                 {"config", fmt::format("{:016x}", s.config_fingerprint())}},
                1.0}};
     }},
    {"topogeo_service_state", MetricKind::kGauge, "1 for the current state of the service, else 0",
     of_states},
    {"topogeo_service_waiting", MetricKind::kGauge,
     "1 while the service waits for something it needs",
     [](const Status& s) { return of_one(s.waits_for().size() > 0 ? 1.0 : 0.0); }},
    {"topogeo_service_start_time_seconds", MetricKind::kGauge, "start of the service, since 1970",
     [](const Status& s) { return of_one(static_cast<double>(s.started_ns()) * kNano); }},
    {"topogeo_inputs_total", MetricKind::kTotal, "main input of the service",
     [](const Status& s) { return of_one(static_cast<double>(s.inputs())); }},
    {"topogeo_input_age_seconds", MetricKind::kGauge, "time since the last main input",
     [](const Status& s) { return s.inputs() == 0 ? Samples{} : of_one(s.input_age_s()); }},
    {"topogeo_faults_total", MetricKind::kTotal, "faults by reason",
     [](const Status& s) { return of_reasons(s.faults()); }},
    {"topogeo_last_error_time_seconds", MetricKind::kGauge, "last fault or failure, since 1970",
     [](const Status& s) {
       return s.last_error().size() == 0
                  ? Samples{}
                  : of_one(static_cast<double>(s.stamp_ns()) * kNano - s.last_error_age_s());
     }},
    {"topogeo_drops_total", MetricKind::kTotal, "dropped inputs by reason",
     [](const Status& s) { return of_reasons(s.drops()); }},
    {"topogeo_messages_total", MetricKind::kTotal, "messages by topic and direction",
     [](const Status& s) {
       return of_traffic(s, [](const auto& one) { return static_cast<double>(one.messages()); });
     }},
    {"topogeo_messages_waiting", MetricKind::kGauge, "messages received and not handled yet",
     of_waiting},
    {"topogeo_queue_depth", MetricKind::kGauge, "work that waits in the service",
     [](const Status& s) { return of_queues(s, false); }},
    {"topogeo_queue_capacity", MetricKind::kGauge, "capacity of queues that have a fixed one",
     [](const Status& s) { return of_queues(s, true); }},
});

/// Labels of a counter, by its declaration.
Labels labels_of(const CounterMetric& metric, std::string_view counter) {
  if (metric.label.empty()) return {};
  if (metric.counter.ends_with('*')) {
    return {{std::string(metric.label), std::string(counter.substr(metric.counter.size() - 1))}};
  }
  const std::size_t equals = metric.label.find('=');
  return {
      {std::string(metric.label.substr(0, equals)), std::string(metric.label.substr(equals + 1))}};
}

Labels with(const Labels& common, Labels own) {
  own.insert(own.begin(), common.begin(), common.end());
  return own;
}

}  // namespace

std::vector<MetricFamily> metrics_of(const msg::ServiceStatus& status) {
  const Labels common = {{"service", status.service().to_string()},
                         {"robot", status.robot_id().to_string()},
                         {"host", status.host().to_string()}};
  std::vector<MetricFamily> families;
  for (const FieldMetric& field : kFieldMetrics) {
    MetricFamily family{std::string(field.metric), std::string(field.help), field.kind, {}};
    for (MetricSample& sample : field.samples(status)) {
      family.samples.push_back({with(common, std::move(sample.labels)), sample.value});
    }
    if (!family.samples.empty()) families.push_back(std::move(family));
  }
  std::map<std::string_view, Samples> by_metric;
  for (const msg::Counter& counter : status.counters()) {
    const std::string name = counter.name().to_string();
    const CounterMetric* metric = find_metric(name);
    if (metric == nullptr) continue;
    by_metric[metric->metric].push_back(
        {with(common, labels_of(*metric, name)), counter.value() * metric->factor});
  }
  for (const CounterMetric& metric : counter_metrics()) {
    const auto found = by_metric.find(metric.metric);
    if (found == by_metric.end()) continue;
    families.push_back({std::string(metric.metric), std::string(metric.help), metric.kind,
                        std::move(found->second)});
    by_metric.erase(found);
  }
  return families;
}

std::vector<std::string> metric_names() {
  std::vector<std::string> names;
  names.reserve(kFieldMetrics.size() + counter_metrics().size());
  for (const FieldMetric& field : kFieldMetrics) names.emplace_back(field.metric);
  for (const CounterMetric& metric : counter_metrics()) names.emplace_back(metric.metric);
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

}  // namespace topogeo::service
