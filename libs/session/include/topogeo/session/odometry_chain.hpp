// Makes the odometry of successive stops comparable when its epoch changes within a session, when
// the session changes within an epoch, or where the scans contradict odometry.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

class OdometryChain {
 public:
  using MapPointer = std::shared_ptr<const topomap::LocalMap>;

  /// Sets the stop before the first call of add().
  void start_after(const topomap::LocalMap& map) {
    last_ = Last{map.stop, map.odometry_epoch, map.T_odom_robot};
  }

  /// Returns the next stop with its odometry, and that of its track, in the frame of its session's
  /// first epoch. Scan tracking gives the step over a change of epoch, and a step of which it
  /// contradicts the odometry. A session that begins in the epoch in which the previous one ended
  /// keeps its frame.
  MapPointer add(MapPointer map);

 private:
  [[nodiscard]] bool is_contradicted(const topomap::LocalMap& map) const;

  struct Last {
    topomap::StopId stop;
    std::uint64_t odometry_epoch = 0;
    geometry::Pose2 T_odom_robot;  // as returned by add()
  };

  std::optional<Last> last_;
  geometry::Pose2 T_first_odom_;  // of the current epoch, in the frame of the first
};

}  // namespace topogeo::localization
