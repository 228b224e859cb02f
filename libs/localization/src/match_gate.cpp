#include "topogeo/localization/match_gate.hpp"

#include <algorithm>

#include <Eigen/LU>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::localization {

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAccepted:
      return "accepted";
    case Verdict::kNothingInCommon:
      return "nothing in common";
    case Verdict::kLittleOverlap:
      return "little overlap";
    case Verdict::kFewInliers:
      return "few inliers";
    case Verdict::kDoubtful:
      return "doubtful";
    case Verdict::kImplausible:
      return "far from the prediction";
    case Verdict::kAmbiguous:
      return "ambiguous";
  }
  return "unknown";
}

double doubt(const MatchResult& result) {
  return result.violations / 0.12 + std::max(0.0, 0.92 - result.inliers) / 0.20 +
         result.residual_rms_m / 0.08 + std::max(0.0, 0.50 - result.scan_fitness) / 0.20;
}

Verdict judge(const MatchTask& task, const MatchResult& result, const GateConfig& config) {
  if (result.status != MatchStatus::kSolved || result.information.isZero()) {
    return Verdict::kNothingInCommon;
  }
  if (result.overlap < config.smallest_overlap) return Verdict::kLittleOverlap;
  if (result.inliers < config.smallest_inliers) return Verdict::kFewInliers;
  const double search_m = std::max(task.half_width.x(), task.half_width.y());
  if (doubt(result) > config.largest_doubt - config.doubt_per_search_m * search_m) {
    return Verdict::kDoubtful;
  }
  const Eigen::Vector3d error =
      geometry::difference(result.T_reference_query, task.T_reference_query);
  if (error.dot(task.covariance.inverse() * error) > config.largest_mahalanobis2) {
    return Verdict::kImplausible;
  }
  if (result.second_fitness > config.largest_ambiguity * result.fitness) return Verdict::kAmbiguous;
  return Verdict::kAccepted;
}

Eigen::Matrix3d match_covariance(const MatchResult& result) {
  constexpr double kFloor_m = 0.02;
  constexpr double kFloor_rad = 0.0052;
  constexpr double kLeastInformation =
      0.25;  // along a bare corridor: a deviation of 2 m, not an infinite one
  Eigen::Matrix3d information = result.information;
  for (int i = 0; i < 3; ++i) information(i, i) += kLeastInformation;
  const double widening = 0.5 + doubt(result);
  Eigen::Matrix3d covariance = information.inverse() * (widening * widening);
  covariance(0, 0) += kFloor_m * kFloor_m;
  covariance(1, 1) += kFloor_m * kFloor_m;
  covariance(2, 2) += kFloor_rad * kFloor_rad;
  return covariance;
}

}  // namespace topogeo::localization
