// Sends goals and orders about them to the robot's navigator.
//
// The navigator takes an order only if it is sent while it is connected (docs/navigation.md,
// "Orders are of the moment"). A navigator may be heard before it is connected with this writer:
// its orders wait for that. Orders for a navigator that is gone are never sent to the next one.
//
// A planner that starts again gets the goal under way from here. Orders to pause and to resume
// therefore have a writer of their own, which leaves the goal stored.
#pragma once

#include <deque>
#include <optional>

#include "topogeo/messaging/events.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/planning.h"
#include "topogeo/service/service.hpp"

namespace topogeo::service {

/// Lives in the loop of its service.
class GoalOutbox {
 public:
  explicit GoalOutbox(Service& service);

  /// Sends as soon as the navigator is connected; at once if none was heard, for a planner alone. A
  /// goal or a cancel replaces orders that still wait. False when the program must end first.
  bool send(const msg::Goal& message);
  /// Takes the information of each status of the navigator.
  void note_navigator(const messaging::SampleInfo& status);

  /// Whether a navigator was heard, which may be gone since.
  [[nodiscard]] bool knows_navigator() const { return navigator_.has_value(); }
  /// Whether it gets what is sent now: it is connected, or was heard and is about to be.
  [[nodiscard]] bool has_navigator() const {
    return navigator_ && (!was_connected_ || is_connected());
  }

 private:
  bool flush();
  [[nodiscard]] bool is_connected() const {
    return goals_.connected_with(*navigator_) && changes_.connected_with(*navigator_);
  }

  Service& service_;
  messaging::Writer<msg::Goal> goals_;          // with orders to cancel
  messaging::Writer<msg::Goal> changes_;        // orders to pause and to resume
  std::optional<messaging::Handle> navigator_;  // the writer of its newest status
  bool was_connected_ = false;
  std::deque<msg::Goal> waiting_;  // for its connection
};

}  // namespace topogeo::service
