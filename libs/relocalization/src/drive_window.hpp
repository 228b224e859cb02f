// The last metres of a drive, independent of any map: relative poses of its stops by odometry and
// by matches with the previous stops, and the views from them.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/matching/odometry_monitor.hpp"
#include "topogeo/slam/match_requests.hpp"
#include "topogeo/slam/place_recognition.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

/// The step from the previous stop.
struct DriveStep {
  UncertainPose T_before_now;  ///< invertible; the identity at the first stop
  double distance_m = 0.0;
  bool matched = false;  ///< false: by odometry alone
  /// Match with the previous stop, if made: the task and its result.
  std::optional<std::pair<MatchTask, MatchResult>> match;
};

class DriveWindow {
 public:
  /// The requests must outlive this.
  explicit DriveWindow(MatchRequests& requests);

  /// Adds the next stop, registered with the requests under the id of `map`; `odometry` from the
  /// previous stop, empty for the first one or after a gap. A gap, or a step by odometry alone,
  /// clears the previous stops.
  DriveStep add(std::shared_ptr<const topomap::LocalMap> map, std::shared_ptr<const StopView> view,
                const std::optional<UncertainPose>& odometry);

  /// Everything seen over the last `length_m` of path, in the frame of the last stop.
  [[nodiscard]] std::vector<SurfacePoint> seen(double length_m) const;
  /// Length of the stored path, at most kKept_m.
  [[nodiscard]] double length_m() const;

  static constexpr double kKept_m = 12.0;

 private:
  struct Stop {
    std::shared_ptr<const topomap::LocalMap> map;
    std::shared_ptr<const StopView> view;
    geometry::Pose2 T_window_robot;
    double path_m = 0.0;
  };
  std::optional<UncertainPose> match_near(const topomap::LocalMap& map,
                                          const UncertainPose& odometry, DriveStep& step);
  std::optional<UncertainPose> match(const topomap::LocalMap& map, const UncertainPose& odometry,
                                     double widening, DriveStep& step);

  MatchRequests& requests_;
  OdometryMonitor monitor_;
  std::deque<Stop> stops_;
};

}  // namespace topogeo::localization
