// Finds the pose of a foreign map in ours: another robot's, or one made of a drawing
// (grid_map.hpp).
//
// Searches some of its stops in the whole of our map, or some of ours in the foreign one if that is
// larger: most stops of a larger map have no counterpart. A single stop can be mistaken for a
// similar one, but many stops rarely agree on a wrong pose. The pose with the most support wins. It
// is refused if another pose has nearly as much support, or if too many stops that our map should
// show do not fit there.
#pragma once

#include <cstddef>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

struct AlignSettings {
  std::size_t stops = 60;      ///< of the smaller map that are searched, [4, 1000]
  std::size_t least = 5;       ///< that must agree
  double least_share = 0.5;    ///< fitting share of the stops that the larger map should show
  double most_rivalry = 0.67;  ///< support of another pose, as a share of the best pose's
};

struct Alignment {
  bool found = false;
  std::string reason;             ///< reason of a refusal
  geometry::Pose2 T_map_foreign;  ///< the best pose, even if refused
  double sigma_m = 0.0;           ///< standard deviation of its position at the middle of the stops
  double sigma_rad = 0.0;
  std::size_t searched = 0;  ///< stops
  std::size_t agreeing = 0;  ///< stops of those that were found near the pose
  std::size_t expected = 0;  ///< stops of those that the larger map should show
  std::size_t fitting = 0;   ///< expected ones that fit there
  double rivalry = 0.0;      ///< support of the second pose, as a share of the best pose's
  double confidence = 0.0;   ///< [0, 1]
};

/// Both maps need stops with poses and scan points. Throws std::invalid_argument naming a map
/// without them, and for settings out of range.
Alignment align(const storage::MapDocument& map, const storage::MapDocument& foreign,
                const AlignSettings& settings = {});

}  // namespace topogeo::exchange
