#include "live_pose_estimate.hpp"

#include <utility>

#include "topogeo/relocalization/map_tracker.hpp"

namespace topogeo::localizer {

void LivePoseEstimate::set_odometry(std::int64_t stamp_ns, std::uint64_t sequence,
                                    const geometry::Pose2& T_odom_robot, std::uint64_t epoch) {
  epoch_ = epoch;
  stamp_ns_ = stamp_ns;
  sequence_ = sequence;
  T_odom_robot_ = T_odom_robot;
}

void LivePoseEstimate::set_tracked(const topomap::StopId& stop, const topomap::TrackedScan& scan) {
  tracked_ = {stop, scan};
}

void LivePoseEstimate::set_stop(std::shared_ptr<const topomap::LocalMap> map) {
  map_ = std::move(map);
  if (map_->stamp_ns >= stamp_ns_) {
    set_odometry(map_->stamp_ns, map_->sequence, map_->T_odom_robot, map_->odometry_epoch);
  }
}

void LivePoseEstimate::correct(const geometry::Pose2& T_map_stop,
                               const Eigen::Matrix3d& covariance) {
  stop_pose_.T_map_robot = T_map_stop;
  stop_pose_.covariance = covariance;
}

geometry::Pose2 LivePoseEstimate::T_stop_robot() const {
  return comparable() ? geometry::between(map_->T_odom_robot, T_odom_robot_) : geometry::Pose2{};
}

std::optional<PoseOfNow> LivePoseEstimate::now() const {
  if (!comparable()) return std::nullopt;
  const bool tracked = tracked_ && tracked_->stop == map_->stop;
  return PoseOfNow{
      stamp_ns_, sequence_,
      localization::live_pose({stop_pose_.T_map_robot, stop_pose_.covariance}, map_->T_odom_robot,
                              tracked ? &tracked_->scan : nullptr, T_odom_robot_, noise_)};
}

}  // namespace topogeo::localizer
