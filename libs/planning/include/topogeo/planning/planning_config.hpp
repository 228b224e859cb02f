// Settings of route planning on nodes and branches.
#pragma once

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::planning {

struct PlanningConfig {
  double max_snap_m = 3.0;
  double min_clearance_m = 0.3;  ///< a branch is closed where its clearance is less, unless it is
                                 ///< virtual; the radius of a B21 is 0.2625 m
};

/// Declares the section `planning`.
void describe(PlanningConfig& config, support::ConfigSchema& schema);

/// Throws std::invalid_argument naming key, value and range.
void check(const PlanningConfig& config);

}  // namespace topogeo::planning
