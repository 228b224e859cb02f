// Settings of the hybrid map: occupancy grid and zones.
#pragma once

#include <cstdint>

#include "topogeo/planning/grid_config.hpp"

namespace topogeo::pipeline {

/// Side of the tiles in which a grid is sent: a growing map must not shift them.
inline constexpr std::int32_t kTileCells = 64;

struct HybridMapConfig {
  planning::ScanGridConfig grid{.snap_cells = kTileCells};
  planning::InflationConfig inflation{.min_pocket_m2 = planning::kPocket_m2};
  planning::ZoneConfig zones;
};

/// Throws std::invalid_argument naming key, value and range; the parts declare the keys.
void check(const HybridMapConfig& config);

}  // namespace topogeo::pipeline
