// Settings of occupancy grids, their inflation and the zones on them.
#pragma once

#include <cstdint>

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::planning {

struct ScanGridConfig {
  double resolution_m = 0.1;
  double margin_m = 1.0;
  /// The lower left corner is at multiples of so many cells, [1, 1024], so that a map that grows
  /// seldom shifts. Not in the configuration file: the tiles on the wire fix it.
  std::int32_t snap_cells = 1;
  // Log-odds in hundredths.
  std::int32_t hit = 85;
  std::int32_t miss = 40;
  std::int32_t limit = 350;
};

struct InflationConfig {
  double forbidden_cells = 3.0;
  bool inflate_unknown = false;  ///< unknown cells themselves are always forbidden
};

struct ZoneConfig {
  double min_area_m2 = 2.0;
  double passage_half_width_m = 0.6;  ///< for zones_by_width
  double cut_reach_m = 0.6;  ///< for zones_between; a passage whose cut meets no forbidden cells is
                             ///< no border
};

// Together they declare the section `hybrid_map`.
void describe(ScanGridConfig& config, support::ConfigSchema& schema);
void describe(InflationConfig& config, support::ConfigSchema& schema);
void describe(ZoneConfig& config, support::ConfigSchema& schema);

// They throw std::invalid_argument naming key, value and range.
void check(const ScanGridConfig& config);
void check(const InflationConfig& config);
void check(const ZoneConfig& config);

}  // namespace topogeo::planning
