#include "topogeo/localization/tracking/pose_fusion.hpp"

#include <algorithm>
#include <iterator>
#include <numbers>

#include <Eigen/LU>

#include "topogeo/localization/tracking/global_localization.hpp"

namespace topogeo::localization {

UncertainPose fused(const std::vector<UncertainPose>& measurements) {
  UncertainPose best = measurements.front();
  if (measurements.size() == 1) return best;
  constexpr int kIterations = 3;  // only the headings are nonlinear
  for (int i = 0; i < kIterations; ++i) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (const UncertainPose& m : measurements) {
      const Eigen::Matrix3d weight = m.covariance.inverse();
      information += weight;
      gradient += weight * geometry::difference(m.T_a_b, best.T_a_b);
    }
    best.covariance = information.inverse();
    const Eigen::Vector3d step = best.covariance * gradient;
    best.T_a_b = {best.T_a_b.x_m + step.x(), best.T_a_b.y_m + step.y(),
                  geometry::wrap_angle(best.T_a_b.theta_rad + step.z())};
  }
  return best;
}

bool heading_is_lost(const UncertainPose& pose) {
  constexpr double kEighth_rad = 0.25 * std::numbers::pi;
  return pose.covariance(2, 2) > kEighth_rad * kEighth_rad;
}

std::vector<bool> of_one_place(const std::vector<geometry::Pose2>& T_map_robot) {
  for (const geometry::Pose2& place : T_map_robot) {
    std::vector<bool> there;
    for (const geometry::Pose2& other : T_map_robot) {
      there.push_back(same_global_place(place, other));
    }
    if (2 * std::ranges::count(there, true) > std::ssize(there)) return there;
  }
  return std::vector<bool>(T_map_robot.size());
}

}  // namespace topogeo::localization
