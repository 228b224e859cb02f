// The robot's goal, and whether it is pursued.
#pragma once

#include <optional>

#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::navigation {

class GoalInHand {
 public:
  void set(const GoalOrder& goal);
  /// False if there is no goal to cancel.
  bool cancel();
  /// Does nothing without a goal.
  void pause() { paused_ = goal_.has_value(); }
  void resume() { paused_ = false; }
  /// Keeps the goal until there is another one or it is cancelled.
  void arrive() { arrived_ = true; }

  [[nodiscard]] const std::optional<GoalOrder>& order() const { return goal_; }
  [[nodiscard]] bool cancelled() const { return cancelled_; }
  [[nodiscard]] bool paused() const { return paused_; }
  [[nodiscard]] bool arrived() const { return arrived_; }

 private:
  std::optional<GoalOrder> goal_;
  bool arrived_ = false;
  bool cancelled_ = false;  ///< the last goal was, and no new one has come
  bool paused_ = false;
};

}  // namespace topogeo::navigation
