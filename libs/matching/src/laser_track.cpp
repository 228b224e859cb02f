#include "laser_track.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "topogeo/matching/refinement.hpp"

#include "match_evidence.hpp"
#include "principal_axes.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// Conditions on a match, those of ScanTracker; and, because no odometry contradicts a wrong one, a
// limit on the share of points that the other scan saw through.
constexpr double kLeastTrackOverlap = 0.3;
struct Limits {
  double inliers;
  double violations;
};
constexpr Limits kNear{0.6, 0.3};
// Stricter after a search, which finds the best of many wrong places too.
constexpr Limits kSearched{0.9, 0.2};

// The neighbouring readings of a scan are not independent: it says as much as so many that are.
constexpr double kIndependentPoints = 30.0;
constexpr double kFitting_m = 0.15;
// A likelihood ratio of e^2 between two places decides nothing.
constexpr double kClearly = 2.0;

// Up to this uncertainty of the prediction the refinement, whose reach is half a metre, finds the
// place by itself.
constexpr double kWithinReach_m = 0.2;
constexpr double kWithinReach_rad = 0.1;
// Extent of the search otherwise. Scans farther apart have little in common.
constexpr double kNearestKeyScan_m = 0.5;
// Error of a place that the search finds, twice the step of its grid.
constexpr double kCoarse_m = 0.25;
constexpr double kCoarse_rad = 0.1;
constexpr double kFarthestKeyScan_m = 2.0;
constexpr double kLeastKeyTurn_rad = 0.35;
constexpr double kMostKeyTurn_rad = 1.6;

// A key scan for each half metre or 20 degrees keeps the views of successive ones alike.
constexpr double kKey_m = 0.5;
constexpr double kKey_rad = 0.35;
constexpr double kKeyOverlap = 0.6;

// The normals of a bare wall are known to within about 4 degrees, so that even its points seem to
// tell the position along it, by this share of their information in all.
constexpr double kNoiseOfNormals = 0.005;

// The information without what the noise of normals pretends.
Eigen::Matrix3d honest(Eigen::Matrix3d information) {
  const double pretended = kNoiseOfNormals * (information(0, 0) + information(1, 1));
  constexpr double kLeast = 1e-2;  // 10 m, 6 rad: nothing
  // Taken off in the direction that is known least, if only that remains. A narrow view knows a
  // shift and a turn together better than either, so the position counts as with unknown heading.
  Eigen::Matrix2d position = information.topLeftCorner<2, 2>();
  if (information(2, 2) > 0.0) {
    const Eigen::Vector2d with_heading = information.topRightCorner<2, 1>();
    position -= with_heading * with_heading.transpose() / information(2, 2);
  }
  const double smallest = principal_axes(position(0, 0), position(0, 1), position(1, 1)).smallest;
  const double taken = std::clamp(smallest - kLeast, 0.0, pretended);
  information(0, 0) -= taken;
  information(1, 1) -= taken;
  return information;
}

// Bare walls leave a position open by 10 m, any others fix it to half a metre.
constexpr double kOpen_m = 1.0;

bool fixes_position(const Eigen::Matrix3d& covariance) {
  return principal_axes(covariance(0, 0), covariance(0, 1), covariance(1, 1)).largest <
         kOpen_m * kOpen_m;
}

Eigen::Matrix3d turned(const Eigen::Matrix3d& covariance, double angle_rad) {
  return geometry::compose_covariance({0.0, 0.0, angle_rad}, Eigen::Matrix3d::Zero(), {},
                                      covariance);
}

// Whether the refinement finds the place by itself.
bool is_near(const UncertainPose& step) {
  return std::max(step.covariance(0, 0), step.covariance(1, 1)) <=
             kWithinReach_m * kWithinReach_m &&
         step.covariance(2, 2) <= kWithinReach_rad * kWithinReach_rad;
}

}  // namespace

LaserTrack::LaserTrack(const TimedFeatures& first) : last_ns_(first.stamp_ns) {
  recent_.add(first.features, {});
}

bool LaserTrack::can_begin(const MatchFeatures& features) {
  constexpr std::ptrdiff_t kFewest = 20;  // a metre of wall
  return std::ranges::count_if(features.surface, &SurfacePoint::on_line) >= kFewest;
}

std::optional<LaserStep> LaserTrack::add(const TimedFeatures& scan) {
  const double dt_s = static_cast<double>(scan.stamp_ns - last_ns_) * 1e-9;
  const UncertainPose step = motion_.predict(dt_s, ++scans_);
  Prediction predicted{compose(T_key_last_, step), is_near(step)};
  predicted.covariance = invertible(predicted.covariance);
  const std::optional<Candidate> match = best_match(*scan.features, predicted);
  if (!match) return std::nullopt;
  return accept(scan, *match, predicted);
}

std::optional<LaserTrack::Candidate> LaserTrack::match_at(const MatchFeatures& features,
                                                          const PosePrior& prior,
                                                          const Prediction& predicted) const {
  const Refinement match = refine(recent_.reference(), features, prior.T_reference_query, prior);
  constexpr double kLargestMahalanobis2 = 16.0;
  const Limits& limits = predicted.near ? kNear : kSearched;
  const double off2 = geometry::squared_mahalanobis(
      geometry::difference(match.T_reference_query, predicted.T_a_b), predicted.covariance);
  if (match.information.isZero() || match.overlap < kLeastTrackOverlap ||
      match.inliers < limits.inliers || match.violations > limits.violations ||
      off2 > kLargestMahalanobis2) {
    return std::nullopt;
  }
  const double blur = match.residual_rms_m / kFitting_m;
  const double fits = match.overlap * (match.inliers * (1.0 - blur * blur) - match.violations);
  return Candidate{match.T_reference_query, match.information, match.overlap,
                   kIndependentPoints * fits - 0.5 * off2};
}

std::optional<LaserTrack::Candidate> LaserTrack::best_match(const MatchFeatures& features,
                                                            const Prediction& predicted) {
  std::optional<Candidate> best =
      match_at(features, {predicted.T_a_b, predicted.covariance.inverse()}, predicted);
  const double sigma_m =
      std::sqrt(std::max(predicted.covariance(0, 0), predicted.covariance(1, 1)));
  const double sigma_rad = std::sqrt(predicted.covariance(2, 2));
  if (best && predicted.near) return best;
  const double reach_m = std::clamp(2.5 * sigma_m, kNearestKeyScan_m, kFarthestKeyScan_m);
  const double turn_rad = std::clamp(2.5 * sigma_rad, kLeastKeyTurn_rad, kMostKeyTurn_rad);
  // Each place is refined by itself: half a metre of reach would draw all of them to one.
  const Eigen::Matrix3d around =
      Eigen::Vector3d(kCoarse_m, kCoarse_m, kCoarse_rad).cwiseAbs2().cwiseInverse().asDiagonal();
  double second = -1e9;
  for (const Pose2& T_guess :
       recent_.search(features, {predicted.T_a_b, {reach_m, reach_m, turn_rad}})) {
    const std::optional<Candidate> other = match_at(features, {T_guess, around}, predicted);
    if (!other) continue;
    const bool same = best && same_place(other->T_key_robot, best->T_key_robot);
    if (!best || other->score > best->score) {
      if (best && !same) second = std::max(second, best->score);
      best = other;
    } else if (!same) {
      second = std::max(second, other->score);
    }
  }
  if (best && second > best->score - kClearly) return std::nullopt;
  return best;
}

LaserStep LaserTrack::accept(const TimedFeatures& scan, const Candidate& match,
                             const UncertainPose& predicted) {
  const double dt_s = static_cast<double>(scan.stamp_ns - last_ns_) * 1e-9;
  const Eigen::Matrix3d seen = honest(match.information);
  const Pose2 T_before_scan = geometry::between(T_key_last_.T_a_b, match.T_key_robot);
  const double back_rad = -T_key_last_.T_a_b.theta_rad;
  constexpr double kNothing = 1e-4;  // keeps it invertible
  const Eigen::Matrix3d measured = (seen + kNothing * Eigen::Matrix3d::Identity()).inverse();
  motion_.update(dt_s, {T_before_scan, turned(measured, back_rad)});
  unseen_m_ = fixes_position(measured) ? 0.0 : unseen_m_ + dt_s * motion_.usual_speed();
  const Eigen::Matrix3d covariance = (seen + predicted.covariance.inverse()).inverse();
  LaserStep step{recent_.T_track_newest() * match.T_key_robot, turned(covariance, back_rad),
                 match.overlap, unseen_m_};
  T_key_last_ = {match.T_key_robot, covariance};
  last_ns_ = scan.stamp_ns;
  scans_ = 0;
  if (match.T_key_robot.position_m().norm() >= kKey_m ||
      std::fabs(match.T_key_robot.theta_rad) >= kKey_rad || match.overlap < kKeyOverlap) {
    recent_.add(scan.features, step.T_track_robot);
    T_key_last_ = {};
  }
  return step;
}

}  // namespace topogeo::localization
