// Decides whether the result of a match is accepted. Every match passes through here, the ones with
// the stop just before too: a single poor match in a turn costs more than all the good ones give.
#pragma once

#include <Eigen/Core>

#include "topogeo/localization/matching/match.hpp"

namespace topogeo::localization {

/// One number for the evidence against a match: 0 for a perfect one, above 2 hardly any is
/// right. Space that one scan saw free and the other occupied weighs most, then points without a
/// partner, large residuals and a low scan fitness. Each part alone rejects too many good matches
/// of sparse or cluttered scans.
double doubt(const MatchResult& result);

/// How well the second pose fits the maps, as a share of how well the result does; 0 without one.
/// Odometry does not count, because a false prediction speaks for the false pose.
/// Only the combined form has odometry in it.
double rivalry(const MatchTask& task, const MatchResult& result);

/// "accepted", "ambiguous", "rejected".
const char* to_string(Verdict verdict);

/// Short English words for a reason, as in reports: "accepted" for none, "little overlap", ...
const char* to_string(Reason reason);

struct Judgement {
  Verdict verdict = Verdict::kRejected;
  Reason reason = Reason::kNothingInCommon;
  friend bool operator==(const Judgement&, const Judgement&) = default;
};

/// What the evidence in `result` comes to by the gate of `task`; its own verdict is not read.
Judgement judge(const MatchTask& task, const MatchResult& result);

/// Covariance of T_reference_query from the Hessian of the data term, in the reference frame, wider
/// the more doubtful the match, with a floor for what the least squares does not know (correlated
/// beams, thick walls): 2 cm and 0.3 degrees.
Eigen::Matrix3d match_covariance(const Eigen::Matrix3d& information, double doubt);

/// The covariance without its margins: the inverse Hessian of the data term alone, as far as it is
/// known. Zero where that of the match is.
Eigen::Matrix3d data_covariance(const MatchResult& result);

/// What match_covariance() adds whatever the match is like.
Eigen::Matrix3d match_covariance_floor();

}  // namespace topogeo::localization
