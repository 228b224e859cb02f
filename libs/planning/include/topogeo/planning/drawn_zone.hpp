// Zones as people draw them on a map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace topogeo::planning {

/// What a drawn zone is for. The values are those of proto/map.proto.
enum class ZoneKind : std::uint8_t {
  kRoom = 0,    ///< a part of the floor with a name
  kNoGo = 1,    ///< to be kept out of
  kSlow = 2,    ///< value: largest speed in m/s
  kOneWay = 3,  ///< value: heading in rad of those who drive through it, map frame
};
inline constexpr std::size_t kZoneKinds = 4;

/// A zone as it is drawn. Of several rooms that overlap the first counts.
struct DrawnZone {
  std::string name;
  std::vector<Eigen::Vector2d> polygon_m;  ///< corners in order, map frame
  ZoneKind kind = ZoneKind::kRoom;
  double value = 0.0;  ///< as its kind says; else 0
};

}  // namespace topogeo::planning
