// The last metres of a drive by themselves, whatever map it is in: how its stops lie to each other
// by odometry and by matches with the stops just before, and all that was seen from them.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/mapping/match_requests.hpp"
#include "topogeo/localization/mapping/odometry_monitor.hpp"
#include "topogeo/localization/matching/match.hpp"
#include "topogeo/localization/matching/odometry_model.hpp"
#include "topogeo/localization/places/place_recognition.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

/// The step from the stop before.
struct DriveStep {
  UncertainPose T_before_now;  ///< invertible; of the first stop: nothing
  double distance_m = 0.0;
  bool matched = false;  ///< false: by odometry alone
  /// With the stop before, when that was matched: the task and its result.
  std::optional<std::pair<MatchTask, MatchResult>> match;
};

class DriveWindow {
 public:
  /// The requests must outlive this.
  explicit DriveWindow(MatchRequests& requests);

  /// The next stop, known to the requests under the id of `map`; `odometry` from the stop before,
  /// nothing at the first one or after a gap. A gap, and a step by odometry alone, forgets the
  /// stops before.
  DriveStep add(std::shared_ptr<const topomap::LocalMap> map, std::shared_ptr<const StopView> view,
                const std::optional<UncertainPose>& odometry);

  /// All that was seen over the last `length_m` of path, in the frame of the last stop, ...
  [[nodiscard]] std::vector<SurfacePoint> seen(double length_m) const;
  /// ... and the path that is known, at most as long as kept_m.
  [[nodiscard]] double length_m() const;

  static constexpr double kKept_m = 12.0;

 private:
  struct Stop {
    std::shared_ptr<const topomap::LocalMap> map;
    std::shared_ptr<const StopView> view;
    geometry::Pose2 T_window_robot;
    double path_m = 0.0;
  };
  std::optional<UncertainPose> match(const topomap::LocalMap& map, const UncertainPose& odometry,
                                     double widening, DriveStep& step);

  MatchRequests& requests_;
  OdometryMonitor monitor_;
  std::deque<Stop> stops_;
};

}  // namespace topogeo::localization
