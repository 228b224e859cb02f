// Rules that close or slow branches besides their clearance: no-go, slow and one-way zones, drawn
// walls, and present obstacles that are not on the map.
//
// The rules are those of the grid (driving_rules.hpp), on a separate grid that needs no map.
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
  /// No rules: everything is open.
  BranchRules() = default;
  /// `frame` limits the rules; everything outside is open. The robot's centre keeps `keep_off_m`
  /// from the centres of cells that are in a no-go zone, of a drawn wall or filled.
  BranchRules(const GridFrame& frame, std::span<const DrawnZone> zones,
              std::span<const DrawnLine> lines, std::span<const Eigen::Vector2d> filled_m,
              double keep_off_m);

  /// No rules apply.
  [[nodiscard]] bool empty() const { return !frame_; }

  /// Whether the robot's centre must not be there.
  [[nodiscard]] bool shut(const Eigen::Vector2d& point_m) const;
  /// Whether the point itself is filled, in a no-go zone or on a drawn wall.
  [[nodiscard]] bool filled(const Eigen::Vector2d& point_m) const;

  struct Passage {
    bool forth = true;      ///< driving from a to b is allowed
    bool back = true;       ///< driving from b to a is allowed
    double slowness = 1.0;  ///< mean factor by which it takes longer than elsewhere
  };
  /// Rules on the straight line between two points.
  [[nodiscard]] Passage along(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const;

 private:
  enum class Place : std::uint8_t { kOpen, kShut, kFilled };
  [[nodiscard]] Place at(const Eigen::Vector2d& point_m) const;

  std::optional<GridFrame> frame_;
  DrivingRules rules_;
  std::vector<Place> places_;  // by cell
};

}  // namespace topogeo::planning
