// Unknown floor that a robot could drive into: the goal of exploration.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/free_space.hpp"

namespace topogeo::navigation {

/// Unknown cells that are passable unless something is seen in them. Excludes the inside of walls,
/// racks and furniture, and floor behind holes too small for the robot.
class UnknownFloor {
 public:
  explicit UnknownFloor(const planning::FreeSpace& space);

  /// False outside of the grid.
  [[nodiscard]] bool contains(const planning::Cell& cell) const;
  /// Whether one of the four neighbouring cells belongs to it.
  [[nodiscard]] bool beside(const planning::Cell& cell) const;

  /// Area that can be driven into straight from a point of the map frame, if it begins at most
  /// `near_m` away: square metres, up to `sight_m` away.
  [[nodiscard]] double ahead_m2(const Eigen::Vector2d& from_m, double near_m, double sight_m) const;

 private:
  enum class Kind : std::uint8_t { kClosed, kKnown, kUnknown };
  planning::GridFrame frame_;
  std::vector<Kind> kinds_;
};

}  // namespace topogeo::navigation
