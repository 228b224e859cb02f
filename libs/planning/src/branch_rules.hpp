// What closes branches or makes them slow besides their clearance: no-go, slow and one-way zones,
// drawn walls, and what fills places now that is not on the map.
//
// The rules are those of the grid (driving_rules.hpp), on a grid of their own that needs no map.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/driving_rules.hpp"

namespace topogeo::planning {

class BranchRules {
 public:
  /// Everything is open.
  BranchRules() = default;
  /// `frame` covers what is to be ruled; beyond it everything is open. The robot's middle keeps
  /// `keep_off_m` from the middles of cells that are in a no-go zone, of a drawn wall or filled.
  BranchRules(const GridFrame& frame, std::span<const DrawnZone> zones,
              std::span<const DrawnLine> lines, std::span<const Eigen::Vector2d> filled_m,
              double keep_off_m);

  /// Nothing is closed, slow or one-way.
  [[nodiscard]] bool empty() const { return !frame_; }

  /// Whether the robot's middle must keep out of a place.
  [[nodiscard]] bool shut(const Eigen::Vector2d& point_m) const;
  /// Whether the place itself is filled, in a no-go zone or of a drawn wall.
  [[nodiscard]] bool filled(const Eigen::Vector2d& point_m) const;

  struct Passage {
    bool forth = true;      ///< one may go from a to b
    bool back = true;       ///< and from b to a
    double slowness = 1.0;  ///< mean: how much longer it takes than elsewhere
  };
  /// The straight line between two points.
  [[nodiscard]] Passage along(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const;

 private:
  enum class Place : std::uint8_t { kOpen, kShut, kFilled };
  [[nodiscard]] Place at(const Eigen::Vector2d& point_m) const;

  std::optional<GridFrame> frame_;
  DrivingRules rules_;
  std::vector<Place> places_;  // by cell
};

}  // namespace topogeo::planning
