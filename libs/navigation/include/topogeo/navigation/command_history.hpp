// Commands of the last second, to predict the pose at which a slow base obeys.
#pragma once

#include <cstdint>
#include <deque>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/geometry/velocity.hpp"

namespace topogeo::navigation {

class CommandHistory {
 public:
  /// `delay_s`: between a command and the base's obedience, [0, 1].
  explicit CommandHistory(double delay_s) : delay_s_(delay_s) {}

  /// Call in time order.
  void add(const geometry::Velocity& command, std::int64_t now_ns);

  /// The pose at which the base will obey: the given one carried on by the commands of the last
  /// `delay_s`.
  [[nodiscard]] geometry::Pose2 predicted(const geometry::Pose2& T_map_robot,
                                          std::int64_t now_ns) const;
  /// Whether the base can only be obeying commands to stand; true before the first.
  [[nodiscard]] bool stands() const;

  /// The last command; zero before the first.
  [[nodiscard]] geometry::Velocity last() const;
  /// Time since the last command; `otherwise_s` before the first.
  [[nodiscard]] double since_last_s(std::int64_t now_ns, double otherwise_s) const;

 private:
  struct Command {
    std::int64_t stamp_ns;
    geometry::Velocity velocity;
  };

  double delay_s_;
  std::deque<Command> commands_;
};

}  // namespace topogeo::navigation
