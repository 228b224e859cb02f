// An order to cancel or to pause that the navigator has not carried out yet. It is repeated,
// because a navigator that starts just then does not get it and drives on. No clock, no transport.
#pragma once

#include <cstdint>
#include <optional>
#include <set>

#include "topogeo/msg/planning.h"

namespace topogeo::web {

class UnconfirmedOrder {
 public:
  /// Names its goal, so that it does not stop another client's newer one.
  struct Repeat {
    msg::GoalKind kind = msg::kGoalCancel;
    std::uint64_t goal_id = 0;
  };

  /// An order of kind kGoalCancel or kGoalPause was sent. It refers to the goal of the newest
  /// status and to `own_goal`, which was sent before it (0: none) and may arrive after it.
  void begin(msg::GoalKind kind, std::uint64_t own_goal);
  /// An operator's goal or an order to resume was sent.
  void end() { kind_.reset(); }
  /// Whether it is a pause. The end of the goal does not confirm it, because the next goal of a
  /// list or an exploration would undo it: it is repeated at the goal.
  [[nodiscard]] bool is_pause() const { return kind_ == msg::kGoalPause; }
  /// Takes each navigator status. Returns the order if it must be sent again.
  std::optional<Repeat> take(const msg::NavigatorStatus& status);

 private:
  static constexpr int kStatuses = 3;  // between repeats: some may be older than the order

  std::optional<msg::GoalKind> kind_;
  std::optional<std::uint64_t> in_hand_;  // the navigator's goal, 0: none; empty: not known yet
  std::uint64_t reached_ = 0;             // the goal at which the robot stands; 0: none
  std::set<std::uint64_t> goals_;         // to which the order refers
  std::uint64_t awaited_ = 0;             // of these, the one that may still arrive; 0: none
  int unseen_ = 0;                        // statuses that do not name it
  int missed_ = 0;                        // statuses without the order's effect
};

}  // namespace topogeo::web
