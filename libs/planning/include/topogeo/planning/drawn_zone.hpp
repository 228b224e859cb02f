// Zones as people draw them on a map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace topogeo::planning {

/// Kind of a drawn zone. The values are those of proto/map.proto.
enum class ZoneKind : std::uint8_t {
  kRoom = 0,       ///< a named part of the floor
  kNoGo = 1,       ///< must not be entered
  kSlow = 2,       ///< value: largest speed in m/s
  kOneWay = 3,     ///< value: heading of the allowed direction in rad, map frame
  kPreferred = 4,  ///< a lane that routes prefer
};
inline constexpr std::size_t kZoneKinds = 5;
inline constexpr double kLeastZoneSpeed_m_s = 0.01;  ///< slower is standing: draw a no_go zone
inline constexpr double kMostZoneSpeed_m_s = 10.0;

/// A drawn zone. If rooms overlap, the first one counts.
struct DrawnZone {
  std::string name;
  std::vector<Eigen::Vector2d> polygon_m;  ///< corners in order, map frame
  ZoneKind kind = ZoneKind::kRoom;
  double value = 0.0;  ///< depends on the kind; else 0
};

}  // namespace topogeo::planning
