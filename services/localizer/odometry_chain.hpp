// Makes the odometry of successive stops comparable when its epoch changes within a session, or
// the session within an epoch.
#pragma once

#include <memory>
#include <optional>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localizer {

class OdometryChain {
 public:
  using MapPointer = std::shared_ptr<const topomap::LocalMap>;

  /// The stop before the first one of add().
  void start_after(const topomap::LocalMap& map) {
    last_ = Last{map.stop, map.odometry_epoch, map.T_odom_robot};
  }

  /// The next stop, its odometry in the frame of the first epoch of its session: over a change of
  /// epoch the step is that of scan tracking. A session that begins in the epoch in which the one
  /// before ended has its frame.
  MapPointer add(MapPointer map);

 private:
  struct Last {
    topomap::StopId stop;
    std::uint64_t odometry_epoch = 0;
    geometry::Pose2 T_odom_robot;  // as it left here
  };

  std::optional<Last> last_;
  geometry::Pose2 T_first_odom_;  // of the epoch that is on, in the frame of the first
};

}  // namespace topogeo::localizer
