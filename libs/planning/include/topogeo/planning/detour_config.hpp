// Settings of detours around obstacles.
#pragma once

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::planning {

struct DetourConfig {
  double half_side_m = 3.0;
  double start_snap_m = 0.5;  ///< like HybridPlannerConfig::start_snap_m: obstacles seen now can be
                              ///< nearer than the forbidden cells
};

/// Declares the detour settings of the section `navigator`.
void describe(DetourConfig& config, support::ConfigSchema& schema);

/// Throws std::invalid_argument naming key, value and range.
void check(const DetourConfig& config);

}  // namespace topogeo::planning
