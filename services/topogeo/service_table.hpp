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
  /// The service ended or is silent.
  void remove(const messaging::SampleInfo& info);

  /// Ordered by service, then instance.
  [[nodiscard]] std::vector<const msg::ServiceStatus*> rows() const;

  /// The status of a service, or nullptr; of several that which started last.
  [[nodiscard]] const msg::ServiceStatus* find(std::string_view service) const;

  /// "navigator, planner": those that are short of CPU time; empty when none is.
  [[nodiscard]] std::string short_of_cpu() const;

  /// Counters of all services but search workers, which may serve other runs too, and but those
  /// that grow without work (CPU time): as long as this does not change, nothing moves.
  [[nodiscard]] std::string progress_mark() const;

 private:
  using Name = std::pair<std::string, std::string>;  // service, instance

  // By name, because the handles of one instance are not always the same: the generated code
  // derives them from a buffer with left-overs between the two strings of this key.
  std::map<Name, msg::ServiceStatus> by_name_;
  std::map<messaging::Handle, Name> names_;
};

/// The value of a counter, 0 if the service has none of that name.
double counter(const msg::ServiceStatus* status, std::string_view name);

/// "the CPU is short: timers fire up to 0.4 s late"; empty for a service that has enough.
std::string cpu_shortage(const msg::ServiceStatus& status);

/// "waiting", "running", ...
std::string_view to_string(msg::ServiceState state);

/// "localizer waiting: for 2 workers", one for each service, separated by "; ".
std::string describe_states(const ServiceTable& table);

}  // namespace topogeo::cli
