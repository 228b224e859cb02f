// A sequence of goals: the current one, and the waiting ones. No clock, no transport.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "topogeo/msg/planning.h"

namespace topogeo::web {

/// A goal resolved on the map.
struct Goal {
  std::uint64_t id = 0;  ///< never 0
  std::string text;      ///< for people
  msg::Goal message;     ///< without header
  double wait_s = 0.0;   ///< that the robot stays there before the next one
  std::uint32_t round = 1;
};

class GoalList {
 public:
  enum class End : std::uint8_t { kArrived, kTakenOver, kNotTaken };
  /// Statuses without a goal after which it counts as lost: a navigator sends at least 5 a second.
  static constexpr int kPatience = 50;

  /// Replaces all goals, or appends to them. True when current() has changed and must be sent.
  bool add(std::deque<Goal> goals, bool append);
  void clear();

  /// Takes a navigator status. Returns how the current goal ended, if it did. After kArrived the
  /// next goal is current() and must be sent. None is left after kTakenOver, because another client
  /// gave or cancelled a goal, and after kNotTaken, because many statuses did not name it: the
  /// navigator, or its connection, began just when the goal was sent.
  ///
  /// A pause holds the next goal back: the goal reached stays current() until a resume. `held`: so
  /// does a pause that the status does not show yet, or the time that the robot stays there.
  std::optional<End> take(const msg::NavigatorStatus& status, bool held = false);

  [[nodiscard]] const std::optional<Goal>& current() const { return current_; }
  [[nodiscard]] const std::deque<Goal>& waiting() const { return waiting_; }

 private:
  std::optional<Goal> current_;
  bool taken_ = false;  // by the navigator
  int missed_ = 0;      // statuses since it was sent that do not name it
  std::deque<Goal> waiting_;
};

}  // namespace topogeo::web
