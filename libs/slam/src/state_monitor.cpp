#include "topogeo/slam/state_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/matching/match_gate.hpp"

namespace topogeo::localization {

namespace {

// The constants below were fitted to simulated drives by tests/bench/kidnapped.cpp --fit and depend
// on each other. Other values would change the meaning of the confidence for all users, so none is
// a setting.
struct Logistic {
  double constant;
  double first;
  double second;
};
constexpr Logistic kMatchRight{7.1, -2.2, 0.0};     // doubt, rivalry
constexpr Logistic kOdometryRight{5.7, -8.5, 0.0};  // contradiction, distance in m

constexpr double kForeseen = 0.35;  // from this overlap on, a match should show something in common
constexpr std::size_t kFewPoints = 12;  // of a blinded laser: such a scan refutes nothing
// Limits of LocalizationStatus::confidence: a pose right to 0.3 m and 5 degrees leads through
// doors.
constexpr double kRight_m = 0.3;
constexpr double kRight_rad = 0.087266463;
// A carried robot is lost within three stops (map_tracker_test), a doubted one seldom
// (tests/bench/kidnapped.cpp).
constexpr double kLostBelow = 0.25;
constexpr double kTrackingFrom = 0.5;   // more probably right than wrong
constexpr double kFirmer = 0.05;        // more than a few matches between two stops cost
constexpr double kDoubtfulShare = 0.3;  // matches that are not accepted have common errors
// Share of a contradiction by the map that counts against a match with a recent own stop: the map
// may have changed there, but only locally.
constexpr double kAgainstOwnStep = 0.25;
constexpr double kElsewhere = 30.0;         // weight of a better place elsewhere, per 1 of fitness
constexpr double kMostConfident = 0.996;    // of any number of matches: they have common errors
constexpr std::uint32_t kOftenDoubted = 2;  // one stop may be doubted because of an obstacle

double value(const Logistic& l, double first, double second) {
  return 1.0 / (1.0 + geometry::exp(-(l.constant + l.first * first + l.second * second)));
}

/// Not accepted, but not refuted.
bool is_doubtful(const StepMatch& match) {
  return match.reason == Reason::kDoubtful || match.reason == Reason::kSecondSolution;
}

double contradiction_of(const StepMatch& match) {
  switch (match.reason) {
    case Reason::kNone:
    case Reason::kSecondSolution:
      return 0.0;
    case Reason::kNothingInCommon:
    case Reason::kFewInliers:
      return 1.0;
    case Reason::kLittleOverlap:  // a small common view may fit well
    case Reason::kDoubtful:
    case Reason::kImplausible:
      return std::min(1.0, std::max(match.violations / 0.12, (1.0 - match.inliers) / 0.5));
  }
  return 0.0;
}

/// Mean over the matches that should have shown something in common and that `counts` selects.
template <typename Counts>
double mean_contradiction(const std::vector<StepMatch>& matches, const Counts& counts) {
  double sum = 0.0;
  double weight = 0.0;
  for (const StepMatch& match : matches) {
    if (match.expected_overlap < kForeseen || !counts(match)) continue;
    sum += match.expected_overlap * contradiction_of(match);
    weight += match.expected_overlap;
  }
  return weight > 0.0 ? sum / weight : 0.0;
}

/// A probability lowered by contradicting evidence.
double lowered(double probability, double contradiction) {
  const double for_it = probability * geometry::exp(kOdometryRight.first * contradiction);
  return for_it / (for_it + 1.0 - probability);
}

}  // namespace

StepMatch step_match(const MatchTask& task, const MatchResult& result, double expected_overlap,
                     std::optional<std::size_t> matched_step) {
  StepMatch match;
  match.verdict = result.verdict;
  match.reason = result.reason;
  match.doubt = doubt(result);
  match.rivalry = rivalry(task, result);
  match.inliers = result.inliers;
  match.violations = result.violations;
  match.expected_overlap = expected_overlap;
  match.matched_step = matched_step;
  return match;
}

double match_confidence(const StepMatch& match) {
  return value(kMatchRight, match.doubt, match.rivalry);
}

double contradiction(const StepEvidence& evidence) {
  if (evidence.points < kFewPoints) return 1.0;
  return mean_contradiction(evidence.matches, [](const StepMatch&) { return true; });
}

double odometry_confidence(const StepEvidence& evidence) {
  return value(kOdometryRight, contradiction(evidence), evidence.distance_m);
}

double covariance_confidence(const Eigen::Matrix3d& covariance) {
  constexpr double kTiny = 1e-12;
  const double variance_m2 = std::max(kTiny, 0.5 * (covariance(0, 0) + covariance(1, 1)));
  const double position = 1.0 - geometry::exp(-0.5 * kRight_m * kRight_m / variance_m2);
  // The error function, within 4e-4 (Winitzki).
  const double x2 = 0.5 * kRight_rad * kRight_rad / std::max(kTiny, covariance(2, 2));
  constexpr double kShape = 0.147;
  constexpr double kFourOverPi = 1.2732395447351628;
  const double exponent = -x2 * (kFourOverPi + kShape * x2) / (1.0 + kShape * x2);
  return position * std::sqrt(1.0 - geometry::exp(exponent));
}

bool place_is_known(const LocalizationStatus& status, const Eigen::Matrix3d& covariance) {
  return located(status.state) &&
         status.confidence >= kTrackingFrom * covariance_confidence(covariance);
}

LocalizationStatus StateMonitor::add(const StepEvidence& evidence) {
  struct Support {
    double before;  // confidence of its source
    double right;   // probability that it is right itself
  };
  const auto before_of = [this](const StepMatch& match) {
    return match.matched_step ? confidence_[*match.matched_step] : 1.0;
  };
  // Only in a finished map, where the robot can be tracked by its own stops out of the mapped area.
  const double against_map = mean_contradiction(
      evidence.matches, [](const StepMatch& match) { return !match.matched_step; });
  std::vector<Support> supports;
  bool any_accepted_match = false;
  for (const StepMatch& match : evidence.matches) {
    if (match.matched_step && *match.matched_step >= confidence_.size()) {
      throw std::invalid_argument("state monitor: match with step " +
                                  std::to_string(*match.matched_step) + ", expected less than " +
                                  std::to_string(confidence_.size()));
    }
    if (match.verdict != Verdict::kAccepted && !is_doubtful(match)) continue;
    any_accepted_match |= match.verdict == Verdict::kAccepted;
    const bool accepted = match.verdict == Verdict::kAccepted;
    double right = (accepted ? 1.0 : kDoubtfulShare) * match_confidence(match);
    if (match.matched_step) right = lowered(right, kAgainstOwnStep * against_map);
    supports.push_back({before_of(match), right});
  }
  if (restarted_) {
    supports.push_back({1.0, lowered(*restarted_, contradiction(evidence))});
  } else {
    supports.push_back({confidence_.back(), odometry_confidence(evidence)});
  }
  // Firmest supports first: others can confirm them, but not raise them. A contradiction with a
  // stop on firmer ground counts against supports that do not share that ground.
  std::stable_sort(supports.begin(), supports.end(),
                   [](const Support& a, const Support& b) { return a.before > b.before; });
  double confidence = 0.0;
  double all_wrong = 1.0;
  for (const Support& support : supports) {
    all_wrong *= 1.0 - support.right;
    const double against = mean_contradiction(evidence.matches, [&](const StepMatch& match) {
      return before_of(match) > support.before + kFirmer;
    });
    confidence = std::max(confidence, lowered(support.before * (1.0 - all_wrong), against));
  }
  confidence = std::min(confidence, kMostConfident);
  const double elsewhere = geometry::exp(-kElsewhere * evidence.better_elsewhere);
  confidence = confidence * elsewhere / (confidence * elsewhere + 1.0 - confidence);
  confidence_.push_back(confidence);
  doubted_ = confidence < kLostBelow ? doubted_ + 1 : 0;
  const bool started = restarted_.has_value();
  restarted_.reset();
  status_.confidence = confidence * covariance_confidence(evidence.covariance);
  if (doubted_ >= kOftenDoubted) {  // one bad scan proves nothing
    status_.state = LocalizationState::kLost;
  } else if ((any_accepted_match || started) && status_.confidence >= kTrackingFrom) {
    status_.state = LocalizationState::kTracking;
  } else {
    status_.state = LocalizationState::kAmbiguous;
  }
  return status_;
}

void StateMonitor::restart(double confidence) {
  restarted_ = confidence;
}

}  // namespace topogeo::localization
