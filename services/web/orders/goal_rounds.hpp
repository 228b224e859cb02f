// A list of goals that is driven several times, and the time that the robot stays at a goal. No
// clock, no transport.
#pragma once

#include <cstdint>
#include <deque>

#include "orders/goal_list.hpp"

namespace topogeo::web {

class GoalRounds {
 public:
  static constexpr std::uint32_t kEndless = 0;

  /// `goals`: the first round, which has begun. `rounds`: how many in all, or kEndless.
  void begin(std::deque<Goal> goals, std::uint32_t rounds);
  /// No further round.
  void end() { *this = {}; }
  /// The goals of the next round, with their ids of before; empty after the last one.
  [[nodiscard]] std::deque<Goal> next();

  [[nodiscard]] bool repeats() const { return rounds_ != 1; }
  /// How many in all, or kEndless.
  [[nodiscard]] std::uint32_t rounds() const { return rounds_; }

 private:
  std::deque<Goal> goals_;
  std::uint32_t rounds_ = 1;
  std::uint32_t begun_ = 1;
};

class GoalWait {
 public:
  /// Whether the robot still has to stay. Its time begins with the first call for this goal.
  /// `now_ns`: of any clock that does not go back.
  [[nodiscard]] bool holds(const Goal& goal, std::int64_t now_ns);
  /// Ends the time at the present goal.
  void skip() { until_ns_ = 0; }
  /// The goal at which the robot stays or has stayed last; 0: none.
  [[nodiscard]] std::uint64_t goal() const { return goal_; }
  /// Seconds that are left at the goal; 0: none.
  [[nodiscard]] double rest_s(std::int64_t now_ns) const;

 private:
  std::uint64_t goal_ = 0;
  std::int64_t until_ns_ = 0;
};

}  // namespace topogeo::web
