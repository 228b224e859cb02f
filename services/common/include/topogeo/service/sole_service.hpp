// Ensures that a robot has only one map store and one localizer: the younger of two stops.
//
// A starting service listens for a moment before it works. A service that already works has
// precedence over one that starts. Two that work, because they did not hear each other before, are
// ranked by their start times, each by the clock of its host: the first one stays. Both sides reach
// the same decision. A killed service does not block its replacement, because it sends no status.
#pragma once

#include <set>
#include <string>

#include "topogeo/msg/status.h"
#include "topogeo/service/service.hpp"

namespace topogeo::service {

/// True when `own` has to stop because `other` has the same task for the same robot.
bool has_precedence(const msg::ServiceStatus& other, const msg::ServiceStatus& own);

class SoleService {
 public:
  /// Listens for a moment, then continues in the loop of the service. Throws std::runtime_error
  /// naming the other service when that has precedence, from here or from the loop.
  explicit SoleService(Service& service);
  SoleService(const SoleService&) = delete;
  SoleService& operator=(const SoleService&) = delete;

 private:
  void compare(const msg::ServiceStatus& received);

  Service& service_;
  bool listening_ = true;           // before the service works
  std::string refused_;             // why it has to stop; empty: it may work
  bool counted_ = false;            // the other service reports the conflict
  std::set<std::string> reported_;  // instances that have to stop
};

}  // namespace topogeo::service
