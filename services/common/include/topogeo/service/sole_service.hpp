// Of a map store and of a localizer there may be only one for a robot: of two the younger stops.
//
// A service that starts listens for a moment before it works. Whoever works already is older than
// one that starts; of two that work, because they did not hear each other before, the one that
// started first by the clock of its host stays. Both sides come to the same conclusion. A service
// that was killed is no rival for the one that takes its place: the dead send no status.
#pragma once

#include <set>
#include <string>

#include "topogeo/msg/status.h"
#include "topogeo/service/service.hpp"

namespace topogeo::service {

/// True when `own` has to stop because `other` does the same for the same robot.
bool has_precedence(const msg::ServiceStatus& other, const msg::ServiceStatus& own);

class SoleService {
 public:
  /// Listens for a moment, and goes on in the loop of the service. Throws std::runtime_error naming
  /// the other one when it has precedence, from here or from the loop.
  explicit SoleService(Service& service);
  SoleService(const SoleService&) = delete;
  SoleService& operator=(const SoleService&) = delete;

 private:
  void compare(const msg::ServiceStatus& received);

  Service& service_;
  bool listening_ = true;           // before it works
  std::string refused_;             // why it has to stop; empty: it has not
  bool counted_ = false;            // the other one reports it
  std::set<std::string> reported_;  // instances that have to stop
};

}  // namespace topogeo::service
