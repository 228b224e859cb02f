// Finds that something has carried the robot away: its wheels have hardly moved since the last scan
// that matched the last stop, yet scan after scan shows another place.
//
// People and doors change a view, too. They hide walls, whereas a robot elsewhere sees beyond the
// walls that were there. And the new place has to stay: the scans must match each other.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/scan_tracker.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::pipeline {

class CarriedWatch {
 public:
  enum class State : std::uint8_t {
    kOnPath,    ///< nothing speaks against the path by odometry
    kUnclear,   ///< the scan shows another place; the next ones decide
    kElsewhere  ///< the robot has been carried, and stays at another place
  };

  CarriedWatch(const localization::ScanTrackerConfig& tracker, const geometry::Pose2& T_robot_laser)
      : T_robot_laser_(T_robot_laser), there_(tracker) {}

  /// Restarts at a stop.
  void start(const scan::Scan& scan) { found(scan); }
  /// Takes the next scan of the same odometry epoch, with its points in the robot frame and its
  /// pose relative to the last stop.
  State add(const scan::Scan& scan, std::span<const topomap::ScanPoint> points,
            const localization::TrackedPose& pose);

 private:
  void found(const scan::Scan& scan);
  [[nodiscard]] bool contradicts(const scan::Scan& scan,
                                 std::span<const topomap::ScanPoint> points) const;

  geometry::Pose2 T_robot_laser_;
  std::optional<scan::Scan> last_matched_;
  localization::ScanTracker there_;  // starts at the first scan of another place
  std::int64_t there_since_ns_ = 0;
  int there_scans_ = 0;
};

}  // namespace topogeo::pipeline
