// What drawn zones demand of those who drive from one point straight to another.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "topogeo/planning/zones.hpp"

namespace topogeo::exchange {

struct DrivingRule {
  bool forward = true;  ///< may be driven from the first point to the second
  bool backward = true;
  std::optional<double> speed_mps;  ///< at most

  [[nodiscard]] bool forbidden() const { return !forward && !backward; }
  /// Both hold: the strictest of each.
  void add(const DrivingRule& other);
};

/// Of the zones that the segment touches. No way leads through a no-go zone; through a one-way zone
/// none that turns more than 120 degrees from its heading, so that it can be crossed.
DrivingRule rule_between(std::span<const planning::DrawnZone> zones, const Eigen::Vector2d& from_m,
                         const Eigen::Vector2d& to_m);

}  // namespace topogeo::exchange
