// The stop in hand of a MapLocalizer.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "topogeo/localization/tracking/map_localizer.hpp"

namespace topogeo::localization {

struct MapLocalizer::Query {
  std::shared_ptr<const topomap::LocalMap> map;  // with its id in the pool
  std::uint64_t hash = 0;
  MatchFeatures features;  // of the scan
  RangeProfile profile;
  UncertainPose odometry;   // since the last stop
  geometry::Pose2 tracked;  // the same by the scan tracker
  bool follows = false;     // there was a stop before
  double way_m = 0.0;
};

}  // namespace topogeo::localization
