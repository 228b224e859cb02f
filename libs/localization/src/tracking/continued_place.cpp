#include "topogeo/localization/tracking/continued_place.hpp"

#include "topogeo/localization/matching/match_gate.hpp"

namespace topogeo::localization {

namespace {

// Steps in succession err together, by far more than their covariances state.
constexpr double kWidening2 = 9.0;
constexpr double kMargin_m = 0.3;
constexpr double kMargin_rad = 0.05;

}  // namespace

void ContinuedPlace::move(const DriveStep& step) {
  // Two scans that may well show the same place were not taken in two places.
  const bool followed =
      step.matched || (step.match && plausible(step.match->first, step.match->second));
  if (!followed) {
    forget();
  } else if (pose_) {
    pose_ = compose(*pose_, step.T_before_now);
  }
}

bool ContinuedPlace::leads_to(const UncertainPose& T_map_robot) const {
  if (!pose_) return true;
  Eigen::Matrix3d covariance = kWidening2 * (pose_->covariance + T_map_robot.covariance);
  covariance.diagonal() +=
      Eigen::Vector3d(kMargin_m * kMargin_m, kMargin_m * kMargin_m, kMargin_rad * kMargin_rad);
  return geometry::squared_mahalanobis(geometry::difference(T_map_robot.T_a_b, pose_->T_a_b),
                                       covariance) <= geometry::kMahalanobis2Of99Percent;
}

}  // namespace topogeo::localization
