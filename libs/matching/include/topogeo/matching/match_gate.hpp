// Decides whether the result of a match is accepted. Every match passes through here, even with the
// previous stop: one poor match in a turn costs more than all the good ones give.
#pragma once

#include <Eigen/Core>

#include "topogeo/matching/match.hpp"

namespace topogeo::localization {

/// The evidence against a match as one number: 0 for a perfect match, and hardly any above 2 is
/// right. Space that one scan saw free and the other occupied weighs most, then points without a
/// partner, large residuals and a low scan fitness. Each part alone rejects too many good matches
/// of sparse or cluttered scans.
double doubt(const MatchResult& result);

/// Fitness of the second pose relative to that of the result, by the maps alone; 0 without a
/// second. Odometry is taken out (only the combined and the weighted form contain it), because a
/// false prediction favours the false pose.
double rivalry(const MatchTask& task, const MatchResult& result);

/// "accepted", "ambiguous", "rejected".
const char* to_string(Verdict verdict);

/// Reason as in reports: "accepted" for none, "little overlap", ...
const char* to_string(Reason reason);

struct Judgement {
  Verdict verdict = Verdict::kRejected;
  Reason reason = Reason::kNothingInCommon;
  friend bool operator==(const Judgement&, const Judgement&) = default;
};

/// Judges the evidence in `result` by the gate of `task`; the verdict in `result` is not read.
Judgement judge(const MatchTask& task, const MatchResult& result);

/// Position deviation along the direction of largest variance.
double weakest_sigma_m(const Eigen::Matrix3d& covariance);

/// Covariance of T_reference_query from the Hessian of the data term, in the reference frame: wider
/// the more doubtful the match, with a floor for errors outside the least squares (correlated
/// beams, thick walls) of 2 cm and 0.3 degrees.
Eigen::Matrix3d match_covariance(const Eigen::Matrix3d& information, double doubt);

/// The covariance without its margins: the inverse Hessian of the data term alone. Zero if that of
/// the match is zero.
Eigen::Matrix3d data_covariance(const MatchResult& result);

/// The covariance of a match for a caller that fuses it with odometry and other matches of nearly
/// the same points: without what errors of normals only seem to know (less_normal_errors()), so
/// that matches along a bare corridor do not add up to a position along it. That of the match for
/// evidence other than scan points.
Eigen::Matrix3d honest_covariance(const MatchResult& result, MatchEvidence evidence);

/// The floor that match_covariance() adds to every match.
Eigen::Matrix3d match_covariance_floor();

}  // namespace topogeo::localization
