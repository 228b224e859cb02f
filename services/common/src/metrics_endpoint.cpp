#include "topogeo/service/metrics_endpoint.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <prometheus/metric_family.h>
#include <prometheus/text_serializer.h>

#include "topogeo/service/service_names.hpp"
#include "topogeo/service/status_metrics.hpp"

#include "http_server.hpp"

namespace topogeo::service {
namespace {

/// Ports for the search workers of one host.
constexpr std::uint32_t kWorkerPorts = 64;

prometheus::ClientMetric to_client_metric(const MetricSample& sample, MetricKind kind) {
  prometheus::ClientMetric metric;
  for (const auto& [name, value] : sample.labels) metric.label.push_back({name, value});
  (kind == MetricKind::kTotal ? metric.counter.value : metric.gauge.value) = sample.value;
  return metric;
}

std::string text_of(const msg::ServiceStatus& status) {
  std::vector<prometheus::MetricFamily> result;
  for (const MetricFamily& family : metrics_of(status)) {
    prometheus::MetricFamily one;
    one.name = family.name;
    one.help = family.help;
    one.type = family.kind == MetricKind::kTotal ? prometheus::MetricType::Counter
                                                 : prometheus::MetricType::Gauge;
    for (const MetricSample& sample : family.samples) {
      one.metric.push_back(to_client_metric(sample, family.kind));
    }
    result.push_back(std::move(one));
  }
  return prometheus::TextSerializer().Serialize(result);
}

}  // namespace

// The server of prometheus-cpp has thread stacks of 100 KB. With the thread-local data of the
// services that is too little, and one malformed request ends the service.
struct MetricsEndpoint::Impl {
  [[nodiscard]] std::string text() {
    std::optional<msg::ServiceStatus> copy;
    {
      const std::lock_guard lock(mutex);
      copy = status;
    }
    return copy ? text_of(*copy) : std::string();
  }

  std::mutex mutex;
  std::optional<msg::ServiceStatus> status;
  std::optional<HttpServer> server;  // destroyed first
};

MetricsEndpoint::MetricsEndpoint(const MetricsAddress& address) : impl_(std::make_unique<Impl>()) {
  std::string why;
  for (std::uint32_t i = 0; i < address.ports && !impl_->server; ++i) {
    try {
      impl_->server.emplace(address.address, address.port + i,
                            HttpPage{"/metrics", "text/plain; version=0.0.4; charset=utf-8",
                                     [impl = impl_.get()] { return impl->text(); }});
    } catch (const std::runtime_error& error) {
      why = error.what();
    }
  }
  if (!impl_->server) {
    throw std::runtime_error("metrics: cannot listen on " + address.address + ", port " +
                             std::to_string(address.port) +
                             (address.ports > 1 ? " and the following" : "") + ": " + why);
  }
  port_ = impl_->server->port();
}

MetricsEndpoint::~MetricsEndpoint() = default;

void MetricsEndpoint::update(const msg::ServiceStatus& status) {
  const std::lock_guard lock(impl_->mutex);
  impl_->status = status;
}

MetricsAddress metrics_address(const std::string& address, std::uint32_t first_port,
                               const std::string& service) {
  const auto found = std::ranges::find(kServiceNames, service);
  const auto place = static_cast<std::uint32_t>(found - kServiceNames.begin());
  const bool after_workers = place > kServiceNames.size() - 2;
  const std::uint32_t port = first_port + place + (after_workers ? kWorkerPorts - 1 : 0);
  return {address, port, service == "ga_worker" ? kWorkerPorts : 1};
}

}  // namespace topogeo::service
