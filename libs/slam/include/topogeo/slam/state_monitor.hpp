// Whether the robot knows its pose, from the view at every stop (docs/algorithms.md, "State of
// localization (own)"): a probability carried from stop to stop, and the state derived from it.
//
// A stop inherits the confidence of the stops that it was matched with. An accepted match passes on
// nearly all of it, a doubtful one a part; odometry alone passes on less, the more the scan
// contradicts the expected view. So a robot that was carried away stays lost, however well the
// later stops fit each other, until a match connects one of them to a stop from before. The shares
// were fitted to simulated drives with kidnapped robots and blinded lasers
// (tests/bench/kidnapped.cpp --fit).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "topogeo/matching/match.hpp"

namespace topogeo::localization {

enum class LocalizationState : std::uint8_t {
  kTracking = 0,   ///< followed from stop to stop by accepted matches
  kAmbiguous = 1,  ///< by odometry or uncertain matches only, or several places fit
  kSearching = 2,  ///< no pose yet, or lost and searching; the pose is meaningless
  kLost = 3,       ///< the scan contradicts the pose; the pose is meaningless
};

inline constexpr std::size_t kLocalizationStates = 4;

/// "TRACKING", "AMBIGUOUS", "SEARCHING", "LOST".
const char* to_string(LocalizationState state);

/// Whether a pose in this state is meaningful.
inline bool located(LocalizationState state) {
  return state == LocalizationState::kTracking || state == LocalizationState::kAmbiguous;
}

struct LocalizationStatus {
  LocalizationState state = LocalizationState::kSearching;
  double confidence = 0.0;  ///< probability that the pose is within 0.3 m and 5 degrees, [0, 1]
};

/// One match as evidence of the pose of a stop.
struct StepMatch {
  Verdict verdict = Verdict::kRejected;
  Reason reason = Reason::kNothingInCommon;
  double doubt = 0.0;             ///< see doubt(); meaningless if nothing is in common
  double rivalry = 0.0;           ///< see rivalry()
  double inliers = 0.0;           ///< [0, 1]
  double violations = 0.0;        ///< [0, 1]
  double expected_overlap = 0.0;  ///< predicted from the poses, [0, 1]
  /// Number of stops before the one it was matched with. Empty: matched with a stop of a finished
  /// map, whose pose is right.
  std::optional<std::size_t> matched_step;
};

/// The evidence in a result.
StepMatch step_match(const MatchTask& task, const MatchResult& result, double expected_overlap,
                     std::optional<std::size_t> matched_step);

/// All evidence at one stop.
struct StepEvidence {
  std::vector<StepMatch> matches;
  std::size_t points = 0;   ///< of the scan; a nearly blind laser proves nothing
  double distance_m = 0.0;  ///< driven since the previous stop
  /// In a finished map: how much better the scan fits the best other place than the pose, as a
  /// difference of GlobalPose::fitness; 0 if it does not, or was not compared.
  double better_elsewhere = 0.0;
  /// Covariance of position (m^2) and heading (rad^2) relative to the reference: the map when
  /// localizing in a finished one, the matched stops when mapping.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

class StateMonitor {
 public:
  /// The status after one more stop. The first stop after the start or restart() is right by
  /// definition, with the `confidence` of restart() (1 at the start). Throws std::invalid_argument
  /// if a match names an unknown step.
  LocalizationStatus add(const StepEvidence& evidence);

  /// The next stop gets its pose from elsewhere (an operator, a search of the whole map), right
  /// with this probability, whatever the stops before showed. Earlier steps keep their numbers.
  void restart(double confidence);

  [[nodiscard]] const LocalizationStatus& status() const { return status_; }
  [[nodiscard]] std::size_t steps() const { return confidence_.size(); }

 private:
  std::vector<double> confidence_;         // for each step: probability that its pose fits the map
  std::optional<double> restarted_ = 1.0;  // confidence of the next step
  std::uint32_t doubted_ = 0;              // successive steps below kLostBelow
  LocalizationStatus status_;
};

/// Probability that an accepted or doubtful match is right.
double match_confidence(const StepMatch& match);

/// How much a scan contradicts its predicted pose, from matches that should have shown something in
/// common, [0, 1]; 0 without such matches.
double contradiction(const StepEvidence& evidence);

/// Probability that the step from the last stop, measured only by odometry, is right.
double odometry_confidence(const StepEvidence& evidence);

/// Probability that a pose with this covariance is within 0.3 m and 5 degrees.
double covariance_confidence(const Eigen::Matrix3d& covariance);

/// Whether a robot is at a known place, more probably than not: it is TRACKING, or would be if its
/// pose were certain, as along a bare corridor.
bool place_is_known(const LocalizationStatus& status, const Eigen::Matrix3d& covariance);

}  // namespace topogeo::localization
