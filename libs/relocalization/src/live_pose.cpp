#include "topogeo/relocalization/map_tracker.hpp"

namespace topogeo::localization {
namespace {

// Deviations of a scan that was matched with that of its stop.
constexpr double kTracked_m = 0.01;
constexpr double kTracked_rad = 0.005;

}  // namespace

UncertainPose live_pose(const UncertainPose& T_map_stop, const geometry::Pose2& T_odom_stop,
                        const topomap::TrackedScan* tracked, const geometry::Pose2& T_odom_robot,
                        const OdometryNoise& noise) {
  if (tracked == nullptr || !tracked->matched) {
    return advance(T_map_stop, geometry::between(T_odom_stop, T_odom_robot), noise);
  }
  const UncertainPose T_stop_scan{
      tracked->T_stop_robot,
      Eigen::Vector3d(kTracked_m * kTracked_m, kTracked_m * kTracked_m, kTracked_rad * kTracked_rad)
          .asDiagonal()};
  return advance(compose(T_map_stop, T_stop_scan),
                 geometry::between(tracked->T_odom_robot, T_odom_robot), noise);
}

}  // namespace topogeo::localization
