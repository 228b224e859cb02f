// Serves the status of a service to Prometheus by HTTP, at /metrics.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "topogeo/msg/status.h"

namespace topogeo::service {

/// Address and ports on which a service listens.
struct MetricsAddress {
  std::string address = "127.0.0.1";
  std::uint32_t port = 0;   ///< 0: any free port
  std::uint32_t ports = 1;  ///< number of ports tried for a free one
};

class MetricsEndpoint {
 public:
  /// Throws std::runtime_error naming address and port when it cannot listen there.
  explicit MetricsEndpoint(const MetricsAddress& address);
  MetricsEndpoint(const MetricsEndpoint&) = delete;
  MetricsEndpoint& operator=(const MetricsEndpoint&) = delete;
  ~MetricsEndpoint();

  /// Sets the status that readers get from now on; nothing before the first call. Thread-safe.
  void update(const msg::ServiceStatus& status);

  [[nodiscard]] std::uint32_t port() const { return port_; }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::uint32_t port_ = 0;
};

/// The place of a service in the range of ports that begins with `first_port`: the gateway has the
/// first, search workers share a range of their own and take its first free port.
MetricsAddress metrics_address(const std::string& address, std::uint32_t first_port,
                               const std::string& service);

}  // namespace topogeo::service
