// The last status of each service of one or more runs.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "topogeo/messaging/events.hpp"
#include "topogeo/msg/status.h"

namespace topogeo::cli {

class ServiceTable {
 public:
  void update(const msg::ServiceStatus& status, const messaging::SampleInfo& info);
  /// Removes a service that has ended or is silent.
  void remove(const messaging::SampleInfo& info);

  /// Ordered by service, then instance.
  [[nodiscard]] std::vector<const msg::ServiceStatus*> rows() const;

  /// The status of a service, or nullptr; of several instances, the one started last.
  [[nodiscard]] const msg::ServiceStatus* find(std::string_view service) const;

  /// "navigator, planner": the services short of CPU time; empty when none is.
  [[nodiscard]] std::string short_of_cpu() const;

  /// Counters of all services except search workers, which may serve other runs too, and without
  /// counters that grow without work (CPU time). While this does not change, nothing moves.
  [[nodiscard]] std::string progress_mark() const;

 private:
  using Name = std::pair<std::string, std::string>;  // service, instance

  // Keyed by name, because the handles of one instance may differ: the generated code derives them
  // from a buffer with remnants between the two strings of this key.
  std::map<Name, msg::ServiceStatus> by_name_;
  std::map<messaging::Handle, Name> names_;
};

/// The value of a counter, 0 if the service has none of that name.
double counter(const msg::ServiceStatus* status, std::string_view name);

/// "the CPU is short: timers fire up to 0.4 s late"; empty for a service with enough CPU time.
std::string cpu_shortage(const msg::ServiceStatus& status);

/// "waiting", "running", ...
std::string_view to_string(msg::ServiceState state);

/// "localizer waiting: for 2 workers" for each service, separated by "; ".
std::string describe_states(const ServiceTable& table);

}  // namespace topogeo::cli
