// Settings of the two forms of a path: motion primitives and smooth arcs.
#pragma once

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::planning {

// Not in the configuration file: both only suppress rounding errors in a list of primitives.
struct PrimitiveConfig {
  double min_turn_rad = 1e-3;   ///< smaller turns are left out, [0, 1]; the next turn includes
                                ///< their sum
  double min_advance_m = 1e-3;  ///< closer points count as one, [0, 1]
};

struct SmoothPathConfig {
  double min_radius_m = 0.2;
  double max_radius_m = 1.0;
  double step_m = 0.1;
};

/// Declares the arc settings of the section `navigator`.
void describe(SmoothPathConfig& config, support::ConfigSchema& schema);

/// Throws std::invalid_argument naming key, value and range.
void check(const SmoothPathConfig& config);

}  // namespace topogeo::planning
