// Settings of route planning on nodes and branches.
#pragma once

#include <cstdint>

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::planning {

struct PlanningConfig {
  double max_snap_m = 3.0;
  double min_clearance_m = 0.3;  ///< a branch is closed where its clearance is less, unless it is
                                 ///< virtual; the radius of a B21 is 0.2625 m
};

/// Preferred basis of a route; the other is used if it has none.
enum class PlanFirstOn : std::uint8_t {
  kHybrid = 0,  ///< grid and zones (MACONDO, III.3)
  kGraph = 1,   ///< nodes and branches (Thesis, 1.1)
};

struct PlannerConfig {
  PlanFirstOn on = PlanFirstOn::kHybrid;
};

/// Declares the section `planner`.
void describe(PlannerConfig& config, support::ConfigSchema& schema);

/// Declares the section `planning`.
void describe(PlanningConfig& config, support::ConfigSchema& schema);

/// Throws std::invalid_argument naming key, value and range.
void check(const PlanningConfig& config);

}  // namespace topogeo::planning
