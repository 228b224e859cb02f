// What can be wrong between the services that are on a domain now.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "topogeo/messaging/discovery.hpp"
#include "topogeo/msg/status.h"

#include "doctor_report.hpp"

namespace topogeo::cli {

/// How far the clock of a host is behind that of this one, from the stamps of messages.
class ClockLag {
 public:
  /// A message with the host's wall clock in it was received at `received_ns` of this one.
  void add(std::int64_t stamp_ns, std::int64_t received_ns);

  [[nodiscard]] std::size_t samples() const { return samples_; }
  /// The least lag of all samples: the time that a message takes makes it larger, never smaller.
  /// Negative for a clock that is ahead.
  [[nodiscard]] double lag_s() const { return lag_s_; }

 private:
  std::size_t samples_ = 0;
  double lag_s_ = 0.0;
};

struct DomainFacts {
  std::vector<msg::ServiceStatus> services;  ///< the last of each
  std::vector<messaging::RemoteEndpoint> endpoints;
  std::map<std::string, std::string> partitions;  ///< by instance; runs have some of their own
  std::map<std::string, ClockLag> clocks;         ///< by host
  std::uint32_t domain = 0;
  std::string host;       ///< that this program runs on
  std::size_t units = 0;  ///< active ones of it whose services join a domain
  std::string version;    ///< of this program
  std::uint32_t wire_version = msg::kSchemaVersion;
};

/// Units of this host, robots, wire contract, versions, configurations, quality of service, clocks.
std::span<const Check<DomainFacts>> domain_checks();

}  // namespace topogeo::cli
