// Where a foreign map lies in ours: another robot's, or one made of a drawing (grid_map.hpp).
//
// Each of some of its stops is searched for in the whole of our map. One stop can be taken for
// another that looks alike, but a pose of the map as a whole on which many stops agree cannot: the
// pose that most of them support is taken, and refused when another is supported nearly as well, or
// when what our map should show of the others is not there.
#pragma once

#include <cstddef>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

struct AlignSettings {
  std::size_t stops = 60;      ///< of the foreign map that are searched for, [4, 1000]
  std::size_t least = 5;       ///< that must agree
  double least_share = 0.5;    ///< of the stops that our map should show, those that fit
  double most_rivalry = 0.67;  ///< support of another pose, as a share of the best one's
};

struct Alignment {
  bool found = false;
  std::string reason;             ///< why not
  geometry::Pose2 T_map_foreign;  ///< the best pose, also when it is refused
  double sigma_m = 0.0;           ///< standard deviation of its position at the middle of the stops
  double sigma_rad = 0.0;
  std::size_t searched = 0;  ///< stops
  std::size_t agreeing = 0;  ///< of those, found where the pose has them
  std::size_t expected = 0;  ///< of those, the ones that our map should show
  std::size_t fitting = 0;   ///< of the expected ones, those that fit there
  double rivalry = 0.0;      ///< support of the second pose, share of the first one's
  double confidence = 0.0;   ///< [0, 1]
};

/// Both maps need stops with poses and scan points. Throws std::invalid_argument for those that
/// have none, naming which, and for settings out of range.
Alignment align(const storage::MapDocument& map, const storage::MapDocument& foreign,
                const AlignSettings& settings = {});

}  // namespace topogeo::exchange
