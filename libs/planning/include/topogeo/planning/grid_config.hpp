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
  /// The lower left corner lies at multiples of this many cells, [1, 1024], so that a growing map
  /// rarely shifts. Not in the configuration file, because the tiles on the wire fix it.
  std::int32_t snap_cells = 1;
  // Log-odds in hundredths.
  std::int32_t hit = 85;
  std::int32_t miss = 40;
  std::int32_t limit = 350;
};

struct InflationConfig {
  double forbidden_cells = 3.0;
  bool inflate_unknown = false;  ///< unknown cells themselves are always forbidden
  /// Smaller connected areas are also forbidden; >= 0. Not in the configuration file, but sent with
  /// a hybrid map.
  double min_pocket_m2 = 0.0;
};
inline constexpr double kPocket_m2 = 1.0;

/// Settings that distinguish rooms from parts of rooms.
struct RoomConfig {
  double narrowing_ratio = 0.55;
  double door_ratio = 0.7;
  double opening_ratio = 0.45;
  double nook_depth = 2.0;
  double column_m = 2.0;
  double furniture_from_m = 0.3;
  double furniture_to_m = 2.5;
};

struct ZoneConfig {
  double min_area_m2 = 2.0;
  double passage_half_width_m = 0.6;  ///< for zones_by_width
  RoomConfig rooms;                   ///< for zones_of_rooms
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
