#include "topogeo/localization/tracking/pose_fusion.hpp"

#include <Eigen/LU>

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

}  // namespace topogeo::localization
