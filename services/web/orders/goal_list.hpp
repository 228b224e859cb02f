// Goals in a row: which one the robot has, and which ones wait. No clock, no transport.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "topogeo/msg/planning.h"

namespace topogeo::web {

/// A goal that the map has.
struct Goal {
  std::uint64_t id = 0;  ///< never 0
  std::string text;      ///< for people
  msg::Goal message;     ///< without header
};

class GoalList {
 public:
  enum class End : std::uint8_t { kArrived, kTakenOver };

  /// Replaces all, or waits behind those that are there. True: current() is another one now and is
  /// to be sent.
  bool add(std::deque<Goal> goals, bool append);
  void clear();

  /// What the navigator reports. Nothing, or how the current goal ended; with kArrived the next one
  /// is current() and is to be sent, with kTakenOver, because somebody else gave or cancelled a
  /// goal, none is left.
  std::optional<End> take(const msg::NavigatorStatus& status);

  [[nodiscard]] const std::optional<Goal>& current() const { return current_; }
  [[nodiscard]] const std::deque<Goal>& waiting() const { return waiting_; }

 private:
  std::optional<Goal> current_;
  bool taken_ = false;  // the navigator has it
  std::deque<Goal> waiting_;
};

}  // namespace topogeo::web
