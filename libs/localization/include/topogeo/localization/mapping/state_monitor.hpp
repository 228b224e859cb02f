// Whether the robot knows where it is, from what every stop saw (docs/algorithms.md, "State of
// localization (own)"): a probability that is carried from stop to stop and the state that follows
// from it.
//
// A stop inherits the confidence of the stops that it was matched with. An accepted match hands on
// nearly all of it, a doubtful one a part; odometry alone hands on the less, the more the scan
// contradicts what should have been seen. So a robot that was carried away stays lost however well
// the stops after it fit each other, until a match ties one of them to a stop from before. How much
// is handed on was fitted to simulated drives with kidnapped robots and blinded lasers
// (tests/bench/kidnapped.cpp --fit).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "topogeo/localization/mapping/localization_state.hpp"
#include "topogeo/localization/matching/match.hpp"

namespace topogeo::localization {

/// One match as evidence of the pose of a stop.
struct StepMatch {
  Verdict verdict = Verdict::kRejected;
  Reason reason = Reason::kNothingInCommon;
  double doubt = 0.0;             ///< see doubt(); means nothing when there is nothing in common
  double rivalry = 0.0;           ///< see rivalry()
  double inliers = 0.0;           ///< [0, 1]
  double violations = 0.0;        ///< [0, 1]
  double expected_overlap = 0.0;  ///< foreseen from the predicted pose, [0, 1]
  /// The stop that it was matched with: how many stops came before it. Nothing: a stop of a
  /// finished map, whose pose is right.
  std::optional<std::size_t> matched_step;
};

/// The evidence in a result.
StepMatch step_match(const MatchTask& task, const MatchResult& result, double expected_overlap,
                     std::optional<std::size_t> matched_step);

/// All that is known at one stop.
struct StepEvidence {
  std::vector<StepMatch> matches;
  std::size_t points = 0;   ///< of the scan; a laser that sees next to nothing proves nothing
  double distance_m = 0.0;  ///< driven since the stop before
  /// In a finished map: how much better the scan fits the best place elsewhere than the pose, as a
  /// difference of GlobalPose::fitness; 0 when it does not, or was not compared.
  double better_elsewhere = 0.0;
  /// Of the position (m^2) and heading (rad^2), relative to what the pose is to be right to: the
  /// map in a finished one, the stops that were matched while mapping.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

class StateMonitor {
 public:
  /// The status after one more stop. The first stop after a start or restart() is right by
  /// definition with the `confidence` of restart() (1 at the start). Throws
  /// std::invalid_argument when a match names a step that has not been.
  LocalizationStatus add(const StepEvidence& evidence);

  /// The next stop's pose comes from elsewhere (an operator, a search of the whole map) and is
  /// right with this probability, whatever the stops before showed. Earlier steps keep their
  /// numbers.
  void restart(double confidence);

  [[nodiscard]] const LocalizationStatus& status() const { return status_; }
  [[nodiscard]] std::size_t steps() const { return confidence_.size(); }

 private:
  std::vector<double> confidence_;         // of each step that its pose is consistent with the map
  std::optional<double> restarted_ = 1.0;  // confidence of the next step
  std::uint32_t doubted_ = 0;              // steps in succession that came out below kLostBelow
  LocalizationStatus status_;
};

/// Probability that an accepted or doubtful match is right.
double match_confidence(const StepMatch& match);

/// How much a scan contradicts its predicted pose, from matches that should have shown something
/// in common, [0, 1]; 0 when none was foreseen to.
double contradiction(const StepEvidence& evidence);

/// Probability that the step from the last stop, known by odometry alone, is right.
double odometry_confidence(const StepEvidence& evidence);

/// Probability that a pose of this covariance is within 0.3 m and 5 degrees.
double covariance_confidence(const Eigen::Matrix3d& covariance);

}  // namespace topogeo::localization
