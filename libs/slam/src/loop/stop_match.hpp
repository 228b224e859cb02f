// Result of a match of two stops, as far as it concerns the map.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/slam/loop/loop_decision.hpp"
#include "topogeo/slam/loop/plausible_match.hpp"
#include "topogeo/slam/pose_graph.hpp"
#include "topogeo/slam/state_monitor.hpp"

namespace topogeo::localization {

struct StopMatch {
  PoseGraphEdge edge;             ///< as measured; as predicted when nothing was in common
  UncertainPose T_later_earlier;  ///< the same, with the covariance of the match itself
  UncertainPose predicted;        ///< of edge.T_from_to, before the match
  ProposalSource source = ProposalSource::kPrediction;
  std::uint32_t first_of_window = 0;  ///< in a window: its first stop
  Verdict verdict = Verdict::kRejected;
  Reason reason = Reason::kNothingInCommon;
  double fitness = 0.0;  ///< [0, 1]
  double doubt = 0.0;    ///< see doubt(); this and the next three as in MatchResult
  double overlap = 0.0;
  double inliers = 0.0;
  double violations = 0.0;
  double rivalry = 0.0;  ///< see rivalry()
  /// Position deviation along the direction that the scans alone determine worst, metres.
  double weakest_sigma_m = 0.0;
  /// Weight of the set it was accepted with, and of the heaviest set that contradicts it
  /// (LoopAgreement); 0: it was not accepted with others.
  double agreement = 0.0;
  double rival_agreement = 0.0;
  bool widened = false;  ///< from a wider search, after the one that odometry asks for failed
  StepMatch evidence;    ///< for the pose of the later stop
  std::vector<MatchSolution> solutions;

  [[nodiscard]] bool accepted() const { return verdict == Verdict::kAccepted; }
  /// See is_doubted().
  [[nodiscard]] bool uncertain() const { return is_doubted(reason); }
  /// Squared Mahalanobis distance of the match from its prediction; 0 without one.
  [[nodiscard]] double surprise() const;
  /// Whether it may be right together with matches that agree with it (LoopAgreement).
  [[nodiscard]] bool plausible() const;
  /// Evidence for the probability that it is right.
  [[nodiscard]] LoopEvidence loop_evidence() const;
};

[[nodiscard]] bool any_accepted(std::span<const StopMatch> matches);

}  // namespace topogeo::localization
