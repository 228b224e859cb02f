#include "topogeo/matching/match_gate.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/refinement.hpp"

#include "fitness_combined.hpp"
#include "principal_axes.hpp"

namespace topogeo::localization {
namespace {

// Fixed: verdicts depend on it, and tasks do not carry it.
constexpr double kOutweighed = 0.12;  // violations at which every match is rejected

/// Along a bare corridor: a deviation of 2 m, not an infinite one. In 1/m^2 and 1/rad^2.
constexpr double kLeastMatchInformation = 0.25;

}  // namespace

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAccepted:
      return "accepted";
    case Verdict::kAmbiguous:
      return "ambiguous";
    case Verdict::kRejected:
      return "rejected";
  }
  return "unknown";
}

const char* to_string(Reason reason) {
  switch (reason) {
    case Reason::kNone:
      return "accepted";
    case Reason::kNothingInCommon:
      return "nothing in common";
    case Reason::kLittleOverlap:
      return "little overlap";
    case Reason::kFewInliers:
      return "few inliers";
    case Reason::kDoubtful:
      return "doubtful";
    case Reason::kImplausible:
      return "far from the prediction";
    case Reason::kSecondSolution:
      return "second solution";
  }
  return "unknown";
}

double doubt(const MatchResult& result) {
  return result.violations / 0.12 + std::max(0.0, 0.92 - result.inliers) / 0.20 +
         result.residual_rms_m / 0.08 + std::max(0.0, 0.50 - result.scan_fitness) / 0.20;
}

double rivalry(const MatchTask& task, const MatchResult& result) {
  if (!(result.second.fitness > 0.0 && result.fitness > 0.0)) return 0.0;
  const double ratio = result.second.fitness / result.fitness;
  if (task.fitness_form != FitnessForm::kCombined &&
      task.fitness_form != FitnessForm::kTopologicalWeighted) {
    return ratio;
  }
  const OdometryPrior prior(task);
  return ratio * prior(result.T_reference_query) / prior(result.second.T_reference_query);
}

Judgement judge(const MatchTask& task, const MatchResult& result) {
  const GateConfig& gate = task.gate;
  const auto rejected = [](Reason reason) { return Judgement{Verdict::kRejected, reason}; };
  if (result.status != MatchStatus::kSolved || result.covariance.isZero(0.0)) {
    return rejected(Reason::kNothingInCommon);
  }
  if (task.evidence == MatchEvidence::kFitness) return {Verdict::kAccepted, Reason::kNone};
  if (result.overlap < gate.smallest_overlap) return rejected(Reason::kLittleOverlap);
  if (result.inliers < gate.smallest_inliers) return rejected(Reason::kFewInliers);
  const double search_m = std::max(task.half_width.x(), task.half_width.y());
  if (doubt(result) > gate.largest_doubt - gate.doubt_per_search_m * search_m) {
    return rejected(Reason::kDoubtful);
  }
  // Right matches show either of the two, but hardly ever both: if another pose fits nearly as
  // well, little evidence against this one is enough (tests/bench/matching.sh).
  const double rival = rivalry(task, result);
  if (rival <= gate.largest_ambiguity && result.violations / kOutweighed + rival > 1.0) {
    return rejected(Reason::kDoubtful);
  }
  const Eigen::Vector3d error =
      geometry::difference(result.T_reference_query, task.T_reference_query);
  if (geometry::squared_mahalanobis(error, task.covariance) > gate.largest_mahalanobis2) {
    return rejected(Reason::kImplausible);
  }
  if (rival > gate.largest_ambiguity) return {Verdict::kAmbiguous, Reason::kSecondSolution};
  return {Verdict::kAccepted, Reason::kNone};
}

double weakest_sigma_m(const Eigen::Matrix3d& c) {
  return std::sqrt(principal_axes(c(0, 0), c(0, 1), c(1, 1)).largest);
}

Eigen::Matrix3d match_covariance_floor() {
  // Fixed: correlated beams and thick walls, which the least squares does not model.
  constexpr double kFloor_m = 0.02;
  constexpr double kFloor_rad = 0.0052;
  return Eigen::Vector3d(kFloor_m * kFloor_m, kFloor_m * kFloor_m, kFloor_rad * kFloor_rad)
      .asDiagonal();
}

Eigen::Matrix3d data_covariance(const MatchResult& result) {
  if (result.covariance.isZero(0.0)) return result.covariance;
  const double widening = 0.5 + doubt(result);
  return (result.covariance - match_covariance_floor()) / (widening * widening);
}

Eigen::Matrix3d honest_covariance(const MatchResult& result, MatchEvidence evidence) {
  constexpr double kNothing = 0.01;  // a deviation of 10 m; keeps it invertible
  const Eigen::LLT<Eigen::Matrix3d> data(data_covariance(result));
  if (evidence != MatchEvidence::kScan || data.info() != Eigen::Success) return result.covariance;
  Eigen::Matrix3d information = data.solve(Eigen::Matrix3d::Identity());
  for (int i = 0; i < 3; ++i) information(i, i) -= kLeastMatchInformation;
  information = less_normal_errors(information, kScanNormalSigma_rad);
  for (int i = 0; i < 3; ++i) information(i, i) += kNothing;
  const double widening = 0.5 + doubt(result);
  return information.inverse() * (widening * widening) + match_covariance_floor();
}

Eigen::Matrix3d match_covariance(const Eigen::Matrix3d& information, double doubt) {
  Eigen::Matrix3d known = information;
  for (int i = 0; i < 3; ++i) known(i, i) += kLeastMatchInformation;
  const double widening = 0.5 + doubt;
  return known.inverse() * (widening * widening) + match_covariance_floor();
}

}  // namespace topogeo::localization
