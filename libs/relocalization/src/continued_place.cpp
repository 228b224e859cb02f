#include "continued_place.hpp"

#include <algorithm>

#include "topogeo/slam/loop/plausible_match.hpp"

namespace topogeo::localization {

namespace {

// Errors of successive steps are correlated, far beyond their covariances.
constexpr double kWidening2 = 9.0;
constexpr double kMargin_m = 0.3;
constexpr double kMargin_rad = 0.05;
// Twice the contradicted path, as for loops (LoopAgreement). Look-alikes were tracked over 10 m
// even when the robot had hardly started. Only a copy of a building is longer than the largest
// value, after which a robot that was carried unnoticed is found again.
constexpr double kOverContradicted = 2.0;
constexpr double kLeast_m = 15.0;
constexpr double kMost_m = 40.0;
// Number of whole scans that must be known to the map, in total, and the share of them that it
// contradicts if the robot is not there: 0 to 15 % at right places, with changed doors and people,
// 20 % or more at wrong ones (docs/decisions/lost_robot.md).
constexpr double kLeastKnown = 1.0;
constexpr double kMostContradicted = 0.2;
constexpr double kBetweenViews_m = 0.5;  // path between two views that count

}  // namespace

void ContinuedPlace::move(const DriveStep& step) {
  // Two scans that may show the same place count as taken at one place.
  const bool followed =
      step.matched || (step.match && plausible(step.match->first, step.match->second));
  if (!followed) {
    pose_.reset();
  } else if (pose_) {
    pose_ = compose(*pose_, step.T_before_now);
  }
}

void ContinuedPlace::track(const UncertainPose& T_map_robot, double distance_m) {
  pose_ = T_map_robot;
  tracked_m_ += distance_m;
  seen_ = {};
  since_m_ = kBetweenViews_m;
}

void ContinuedPlace::compare(const KnownView& view, double distance_m) {
  since_m_ += distance_m;
  if (!pose_ || since_m_ < kBetweenViews_m) return;
  since_m_ = 0.0;
  seen_.there += view.there;
  seen_.contradicted += view.contradicted;
  if (seen_.known() >= kLeastKnown && seen_.contradicted > kMostContradicted * seen_.known()) {
    pose_.reset();
  }
}

void ContinuedPlace::forget() {
  pose_.reset();
  seen_ = {};
  tracked_m_ = 0.0;
}

double ContinuedPlace::wanted_m(const UncertainPose& T_map_robot) const {
  return leads_to(T_map_robot) ? 0.0
                               : std::clamp(kOverContradicted * tracked_m_, kLeast_m, kMost_m);
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
