// Driving rules of drawn zones for a straight segment.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "topogeo/planning/zones.hpp"

namespace topogeo::exchange {

struct DrivingRule {
  bool forward = true;  ///< the segment may be driven from its first point to its second
  bool backward = true;
  std::optional<double> speed_mps;  ///< at most

  [[nodiscard]] bool forbidden() const { return !forward && !backward; }
  /// Combines both rules: the stricter part of each applies.
  void add(const DrivingRule& other);
};

/// Combines the rules of the zones that the segment touches. A no-go zone forbids both directions.
/// A one-way zone forbids directions that deviate more than 120 degrees from its heading, so that
/// it can be crossed.
DrivingRule rule_between(std::span<const planning::DrawnZone> zones, const Eigen::Vector2d& from_m,
                         const Eigen::Vector2d& to_m);

}  // namespace topogeo::exchange
