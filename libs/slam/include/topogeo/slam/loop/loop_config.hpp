// Every threshold that decides whether a match closes a loop, in the order in which
// LoopClosing::judge() applies them (loop_closing.hpp). The tables that chose them are in
// docs/decisions/loop_acceptance.md.
//
// Two sets are settings of users and declared elsewhere: the gate of every match, which comes first
// (`gate.*`, GateConfig in match_config.hpp), and the correction that one loop may make alone
// (`localizer.unaided_correction_*`, LocalizerConfig).
#pragma once

#include <cstddef>
#include <cstdint>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::localization {

/// Matches of a widened search, before they place a stop (look_alikes.hpp).
struct LookAlikeLimits {
  /// Squared Mahalanobis distance from odometry: 99 % of right matches are nearer.
  static constexpr double kAllowed2 = geometry::kMahalanobis2Of99Percent;
};

/// A match that may be right together with others, although its gate doubted it (plausible()).
struct PlausibleMatch {
  /// Wider than the gate: right matches in clutter reach doubt 4.5, and no set of wrong ones agrees
  /// up to there.
  static constexpr double kMostDoubt = 4.5;
  static constexpr double kLeastInliers = 0.6;
  static constexpr double kLeastOverlap = 0.3;
  static constexpr double kMostViolations = 0.3;
  /// Along a bare corridor the scans allow any place; a position by odometry is no evidence there.
  static constexpr double kLeastKnown_m = 0.2;
  static constexpr double kMostRivalry = 0.9;
  /// Fitness of a window, which has no inliers and no doubt of its own.
  static constexpr double kLeastOfWindow = 0.88;
};

/// A match that passed its gate and is judged alone (LoopClosing::judge_alone()).
struct SingleLoopLimits {
  /// Squared Mahalanobis distance from the prediction. A match beyond 99 % needs others that agree,
  /// however little it moves the robot.
  static constexpr double kMostSurprise2 = geometry::kMahalanobis2Of99Percent;
  /// Two cells of a 5 cm grid: a smaller correction needs no optimisation of its own.
  static constexpr double kNoticeable_m = 0.1;
  /// Stops until a pending loop is dropped: by then odometry has drifted too far for agreement.
  static constexpr std::uint32_t kLongestWait = 12;
};

/// Effort and tolerance of a search for consistent poses along a loop, which a loop with a large
/// correction must pass (closing_check.hpp, loop_search.hpp).
struct LoopSearchConfig {
  std::uint32_t beam_width = 60;  ///< paths that advance together; a wider beam finds better ones
                                  ///< at a proportional cost (benchmark backward/60)
  std::uint32_t waiting = 120;    ///< paths kept at each pose for backtracking
  std::uint64_t largest_work = 400'000;  ///< steps tried in all; bounds the work on a hopeless loop
  double probability = 0.99;  ///< of the ellipse whose rectangle must contain a pose: all poses of
                              ///< a loop must be inside, so 95 % each would refuse many right loops
  double heading_sigmas = 3.0;
  double resolution_m = 0.15;           ///< resolution of the genetic search:
  double resolution_rad = 0.034906585;  ///< the smallest half-width of an uncertainty
  bool draw = true;                     ///< also tries each pose drawn towards the expected one
  std::uint32_t paths_wanted = 3;       ///< best paths returned
  friend bool operator==(const LoopSearchConfig&, const LoopSearchConfig&) = default;
};

/// Combined weight of stops whose matches agree, for loops (LoopAgreement) and for a robot that is
/// searched in a finished map (DriveAgreement).
struct AgreementWeights {
  static constexpr double kPassed = 1.5;  ///< a stop with a match that passed its gate
  static constexpr double kDoubtful = 1.0;
  static constexpr double kLeastSpread_m = 2.0;  ///< path between the first and the last
  /// Required sum for a robot that may be anywhere in a map.
  static constexpr double kWantedAnywhere = 4.0;
  /// Required sum for a loop: less, because its prediction is evidence too.
  static constexpr double kWantedOfLoop = 3.0;
  /// A set that contradicts the prediction needs more, per logarithm of the squared Mahalanobis
  /// distance, because predictions are far off more often than a Gaussian allows.
  static constexpr double kPerSurprise = 0.75;
  static constexpr double kOverRival = 2.0;  ///< required weight of an accepted set over its rivals
  /// Path between two stops that count once each: nearer stops see much the same, and each of more
  /// distant ones sees more that is new.
  static constexpr double kCountedApart_m = 0.75;
  static constexpr double kLeastShare = 0.6;  ///< of a stop that is nearer
  static constexpr double kMostShare = 1.5;   ///< of one that is farther
};

/// Loops that agree with each other (LoopAgreement).
struct LoopAgreementLimits {
  /// Squared Mahalanobis distance of two loops: 95 % of right pairs (chi-square, three degrees of
  /// freedom).
  static constexpr double kAgree2 = 7.8;
  /// Over a longer path odometry is too uncertain for a contradiction between two loops.
  static constexpr double kFarthest_m = 25.0;
  /// Round trips over two agreeing loops end nearer to their start.
  static constexpr double kFarOff_m = 5.0;
  /// Squared Mahalanobis distance from the prediction, as for a single loop: a set within it agrees
  /// with the prediction.
  static constexpr double kMostSurprise2 = SingleLoopLimits::kMostSurprise2;
  /// Required of each match in a set that agrees with the prediction: less probable ones are less
  /// accurate than the rest of their set, and one in fifty of them is more than half a metre off.
  static constexpr double kLeastProbability = 0.98;
  static constexpr std::size_t kRivalSeeds = 8;  ///< sets of rivals that are weighed
  /// Older hypotheses had their chance: this bounds the work of a step.
  static constexpr double kForgotten_m = 60.0;
};

/// Accepted loops after an optimisation (outvoted_loop.hpp).
struct OutvotedLoopLimits {
  /// Squared Mahalanobis distance of a loop from the optimised poses: a right loop comes this far
  /// once in a million (chi-square, three degrees of freedom).
  static constexpr double kOutvoted2 = 30.0;
};

}  // namespace topogeo::localization
