// What the services of one or more runs last said of themselves.
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

  /// The status of a service, or nullptr; the first one if there are several.
  [[nodiscard]] const msg::ServiceStatus* find(std::string_view service) const;

  /// Counters of all services but those that grow without work (CPU time): as long as this does not
  /// change, nothing moves.
  [[nodiscard]] std::string progress_mark() const;

 private:
  std::map<messaging::Handle, msg::ServiceStatus> by_instance_;
};

/// The value of a counter, 0 if the service has none of that name.
double counter(const msg::ServiceStatus* status, std::string_view name);

/// "waiting", "running", ...
std::string_view to_string(msg::ServiceState state);

/// "localizer waiting: for 2 workers", one for each service, separated by "; ".
std::string describe_states(const ServiceTable& table);

/// One line for people: service, instance, host, state, uptime, message, counters, faults.
std::string status_line(const msg::ServiceStatus& status);

}  // namespace topogeo::cli
