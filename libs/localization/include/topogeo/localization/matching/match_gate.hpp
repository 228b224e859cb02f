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
/// Only the combined and the weighted form have odometry in them.
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

/// Whether a match may be right together with others that agree with it: its gate let it pass, or
/// doubted it for no more than clutter and people bring about, and the scans know the position in
/// every direction. Its distance from the prediction is not judged.
bool plausible(const MatchTask& task, const MatchResult& result);

/// What plausible() allows.
struct PlausibleMatch {
  /// Wider than the gate: doubt 4.5 is that of right matches in clutter, and more than any set of
  /// wrong ones agrees on (tests/bench/RESULTS.md, "Loops").
  static constexpr double kMostDoubt = 4.5;
  static constexpr double kLeastInliers = 0.6;
  static constexpr double kLeastOverlap = 0.3;
  static constexpr double kMostViolations = 0.3;
  /// Along a bare corridor the scans allow any place: what odometry says there is no evidence.
  static constexpr double kLeastKnown_m = 0.2;
  static constexpr double kMostRivalry = 0.9;
};

/// What stops whose matches agree are worth together (LoopAgreement, DriveAgreement).
struct AgreementWeights {
  static constexpr double kPassed = 1.5;  ///< a stop with a match that passed its gate
  static constexpr double kDoubtful = 1.0;
  static constexpr double kWanted = 4.0;         ///< before they are right together
  static constexpr double kLeastSpread_m = 2.0;  ///< of path between the first and the last
};

/// Deviation of the position along the direction in which a covariance knows it least.
double weakest_sigma_m(const Eigen::Matrix3d& covariance);

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
