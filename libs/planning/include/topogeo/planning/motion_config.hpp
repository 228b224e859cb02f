// Settings of the two forms of a path: motion primitives and smooth arcs.
#pragma once

namespace topogeo::planning {

struct PrimitiveConfig {
  double min_turn_rad = 1e-3;   ///< smaller turns are left out, [0, 1]; what they add up to is
                                ///< made good at the next turn
  double min_advance_m = 1e-3;  ///< points nearer together count as one, [0, 1]
};

struct SmoothPathConfig {
  double min_radius_m = 0.2;  ///< tightest arc; corners with no room for it are turned on the spot,
                              ///< [0.01, 10]
  double max_radius_m = 1.0;  ///< arcs are as wide as fits, up to this, [min_radius_m, 100]
  double step_m = 0.1;        ///< between samples at most, [0.005, 10]
};

/// Throws std::invalid_argument naming the field, the value and the range that it must lie in.
void check(const SmoothPathConfig& config);

}  // namespace topogeo::planning
