#include "pose_fusion.hpp"

#include <algorithm>
#include <numbers>

#include <Eigen/LU>

#include "topogeo/relocalization/global_localization.hpp"

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

bool agree(const UncertainPose& predicted, const UncertainPose& measured, double most2) {
  return geometry::squared_mahalanobis(geometry::difference(measured.T_a_b, predicted.T_a_b),
                                       predicted.covariance + measured.covariance) <= most2;
}

bool heading_is_lost(const UncertainPose& pose) {
  constexpr double kEighth_rad = 0.25 * std::numbers::pi;
  return pose.covariance(2, 2) > kEighth_rad * kEighth_rad;
}

std::vector<bool> of_one_place(const std::vector<UncertainPose>& T_map_robot,
                               const std::vector<bool>& chosen, int fewest) {
  const auto all = std::ranges::count(chosen, true);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!chosen[i]) continue;
    std::vector<bool> there(chosen.size());
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      there[k] = chosen[k] && same_global_place(T_map_robot[i].T_a_b, T_map_robot[k].T_a_b);
    }
    const auto count = std::ranges::count(there, true);
    if (2 * count > all && count >= fewest) return there;
  }
  return std::vector<bool>(chosen.size());
}

}  // namespace topogeo::localization
