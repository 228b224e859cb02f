// Checks for faults between the services that are now on a domain.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "topogeo/messaging/discovery.hpp"
#include "topogeo/msg/status.h"

#include "diagnose/doctor_report.hpp"

namespace topogeo::cli {

/// Lag of a host's clock behind the clock of this host, from the stamps of messages.
class ClockLag {
 public:
  /// Adds a message with the other host's wall clock, received at `received_ns` of this host's
  /// clock.
  void add(std::int64_t stamp_ns, std::int64_t received_ns);

  [[nodiscard]] std::size_t samples() const { return samples_; }
  /// The smallest lag of all samples, because the transport time only increases it. Negative for a
  /// clock that is ahead.
  [[nodiscard]] double lag_s() const { return lag_s_; }

 private:
  std::size_t samples_ = 0;
  double lag_s_ = 0.0;
};

struct DomainFacts {
  std::vector<msg::ServiceStatus> services;  ///< newest status of each service
  std::vector<messaging::RemoteEndpoint> endpoints;
  std::map<std::string, std::string> partitions;  ///< by instance; each `topogeo run` has its own
  std::map<std::string, ClockLag> clocks;         ///< by host
  std::uint32_t domain = 0;
  std::string host;                ///< host of this program
  std::string unanswered_servers;  ///< see unanswered_servers()
  std::string elsewhere;           ///< see services_elsewhere()
  std::size_t units = 0;  ///< number of active units of this host whose services join a domain
  std::string version;    ///< of this program
  std::uint32_t wire_version = msg::kSchemaVersion;
};

/// Units of this host, robots, wire contract, versions, configurations, quality of service, clocks.
std::span<const Check<DomainFacts>> domain_checks();

}  // namespace topogeo::cli
