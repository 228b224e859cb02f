// Settings of occupancy grids, their inflation and the zones on them.
#pragma once

#include <cstdint>

namespace topogeo::planning {

struct ScanGridConfig {
  double resolution_m = 0.1;    ///< [0.01, 1]
  double margin_m = 1.0;        ///< around what was seen, [0, 100]
  std::int32_t snap_cells = 1;  ///< the lower left corner is at multiples of so many cells, [1,
                                ///< 1024], so that a map that grows seldom shifts
  // Log-odds in hundredths, kept within +-limit so that a door that is shut later becomes a wall.
  std::int32_t hit = 85;     ///< added where a beam ends, [1, 1000]
  std::int32_t miss = 40;    ///< taken off where one passes, [1, 1000]
  std::int32_t limit = 350;  ///< [1, 10000]
};

/// Throws std::invalid_argument naming the field, the value and the range that it must lie in.
void check(const ScanGridConfig& config);

struct InflationConfig {
  double forbidden_cells = 3.0;  ///< a cell is forbidden when the middle of an occupied one is at
                                 ///< most so many cells away, [0, 100]
  bool inflate_unknown = false;  ///< unknown cells are always forbidden; true: also the cells near
                                 ///< them
};

/// Throws std::invalid_argument naming the field, the value and the range that it must lie in.
void check(const InflationConfig& config);

struct ZoneConfig {
  double min_area_m2 = 2.0;  ///< zones that are smaller join the neighbour with the longest border,
                             ///< drawn ones excepted, [0, 1000]
  /// For zones_by_width: where less than this is free on either side, a passage is narrow, (0, 5].
  double passage_half_width_m = 0.6;
  /// For zones_between: how much further than the passage's clearance a cut may have to go to meet
  /// forbidden cells, [0, 5] m. A passage whose cut ends in the open is no border.
  double cut_reach_m = 0.6;
};

/// Throws std::invalid_argument naming the field, the value and the range that it must lie in.
void check(const ZoneConfig& config);

}  // namespace topogeo::planning
