// Gives the status of a service to Prometheus by HTTP, at /metrics.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "topogeo/msg/status.h"

namespace topogeo::service {

/// Where a service listens.
struct MetricsAddress {
  std::string address = "127.0.0.1";
  std::uint32_t port = 0;   ///< 0: any that is free
  std::uint32_t ports = 1;  ///< the first free one of so many
};

class MetricsEndpoint {
 public:
  /// Throws std::runtime_error naming address and port when it cannot listen there.
  explicit MetricsEndpoint(const MetricsAddress& address);
  MetricsEndpoint(const MetricsEndpoint&) = delete;
  MetricsEndpoint& operator=(const MetricsEndpoint&) = delete;
  ~MetricsEndpoint();

  /// What readers get from now on; nothing before the first. For any thread.
  void update(const msg::ServiceStatus& status);

  [[nodiscard]] std::uint32_t port() const { return port_; }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::uint32_t port_ = 0;
};

/// The place of a service in the row of ports that a configuration begins: the gateway has the
/// first, search workers the first free one of the last.
MetricsAddress metrics_address(const std::string& address, std::uint32_t first_port,
                               const std::string& service);

}  // namespace topogeo::service
