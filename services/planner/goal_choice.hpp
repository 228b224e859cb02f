// Chooses the goal to plan for among all that clients have given: the one that the navigator has.
//
// Clients' goals are stored messages, so a planner that starts receives ended ones, too, in any
// order. The navigator's status says which of them counts. Without a navigator, for example beside
// another follower of routes, the newest goal counts until it is cancelled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "topogeo/msg/planning.h"

namespace topogeo::planner {

class GoalChoice {
 public:
  /// Takes a valid goal. True: it is the chosen one, and needs a route.
  bool add(const msg::Goal& goal);
  /// Takes an order to cancel; the status of a navigator decides instead if there is one.
  void cancel(const msg::Goal& order);
  /// Takes the navigator's status. True: another goal is the chosen one, and needs a route.
  bool take(const msg::NavigatorStatus& status);

  /// There is no navigator any more: the newest goal counts again.
  void lose_navigator() { in_hand_.reset(); }

  /// Empty: no route is needed.
  [[nodiscard]] const std::optional<msg::Goal>& chosen() const { return chosen_; }

 private:
  static constexpr std::size_t kMost = 64;  // each client stores one, and one of them counts

  std::deque<msg::Goal> given_;           // oldest first
  std::optional<std::uint64_t> in_hand_;  // goal id of the navigator, 0: none; empty: unknown
  std::optional<msg::Goal> chosen_;
};

}  // namespace topogeo::planner
