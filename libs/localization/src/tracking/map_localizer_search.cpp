// The part of MapLocalizer that looks for a robot whose pose is not known.
#include <algorithm>
#include <cmath>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/localization/tracking/map_localizer.hpp"

#include "map_localizer_query.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

constexpr std::size_t kPlaces = 8;  // looked at in one stop
constexpr std::size_t kMostHypotheses = 16;
constexpr std::size_t kFewestSearched = 25;  // fewer prove nothing
constexpr double kProposed_m = 0.25;         // of a place that the fields found
constexpr double kProposed_rad = 0.08;
constexpr double kSharpness = 25.0;         // of the weights in the fitness: e^2.5 for each 0.1
constexpr double kElsewhereFitness = 0.60;  // of the best place if the robot is somewhere else
constexpr double kElsewhereWeight = 0.5;    // weight of that before anything was seen
constexpr double kNewWeight = 0.05;         // of a place that nothing before spoke for
constexpr double kForgotten = 1e-4;
constexpr double kSure = 0.95;
constexpr std::uint32_t kSeenOften = 2;  // believed stops before a place is taken
// More of them for a place that the stops of this search before did not speak for.
constexpr std::uint32_t kSeenMoreOften = 4;
constexpr double kLeastWay_m = 0.3;  // between the first and the last of them
constexpr std::uint32_t kMissedOften = 3;

bool same_hypothesis(const Pose2& a, const Pose2& b) {
  constexpr double kApart_m = 0.6;
  constexpr double kApart_rad = 0.3;
  return (a.position_m() - b.position_m()).squaredNorm() < kApart_m * kApart_m &&
         std::fabs(geometry::wrap_angle(a.theta_rad - b.theta_rad)) < kApart_rad;
}

}  // namespace

void MapLocalizer::search_step(const Query& query) {
  for (Hypothesis& hypothesis : hypotheses_) {
    hypothesis.pose = {
        hypothesis.pose.T_a_b * query.odometry.T_a_b,
        geometry::compose_covariance(hypothesis.pose.T_a_b, hypothesis.pose.covariance,
                                     query.odometry.T_a_b, query.odometry.covariance)};
    hypothesis.way_m += query.way_m;
  }
  propose(query);
  weigh(query);
  ++searched_;
  decide();
}

// Adds the places of the whole map that fit this scan and that nothing before spoke for.
void MapLocalizer::propose(const Query& query) {
  if (query.features.coarse.size() < kFewestSearched) return;
  for (const Climbed& place : global_.places(query.features, kPlaces)) {
    const bool known = std::any_of(
        hypotheses_.begin(), hypotheses_.end(),
        [&](const Hypothesis& h) { return same_hypothesis(h.pose.T_a_b, place.T_map_robot); });
    if (known) continue;
    Hypothesis hypothesis;
    hypothesis.pose = {place.T_map_robot,
                       Eigen::Vector3d(kProposed_m * kProposed_m, kProposed_m * kProposed_m,
                                       kProposed_rad * kProposed_rad)
                           .asDiagonal()};
    hypothesis.weight = kNewWeight;
    hypothesis.wanted = std::min(kSeenMoreOften, kSeenOften + searched_);
    hypotheses_.push_back(hypothesis);
  }
}

// Matches each place with the stored stop that sees it best, as tasks of the pool.
void MapLocalizer::weigh(const Query& query) {
  if (query.features.coarse.size() < kFewestSearched || hypotheses_.empty()) return;
  std::vector<MatchTask> tasks;
  std::vector<std::size_t> stops;
  for (const Hypothesis& hypothesis : hypotheses_) {
    double share = 0.0;
    stops.push_back(global_.best_stop(query.features, hypothesis.pose.T_a_b, share));
    tasks.push_back(make_task(query, stops.back(), hypothesis.pose));
  }
  const std::vector<MatchResult> results = pool_.match(tasks);
  double elsewhere = kElsewhereWeight;
  for (const Hypothesis& hypothesis : hypotheses_) elsewhere -= hypothesis.weight;
  elsewhere = std::max(kNewWeight, elsewhere);
  double sum = elsewhere;
  for (std::size_t i = 0; i < results.size(); ++i) {
    count(results[i]);
    Hypothesis& hypothesis = hypotheses_[i];
    const bool believed =
        results[i].verdict == Verdict::kAccepted || results[i].reason == Reason::kSecondSolution;
    if (believed) {
      const UncertainPose seen = measured(stops[i], results[i]);
      hypothesis.pose = hypothesis.seen == 0 ? seen : fused({hypothesis.pose, seen});
      if (hypothesis.seen == 0) hypothesis.way_m = 0.0;
      ++hypothesis.seen;
      hypothesis.missed = 0;
    } else {
      ++hypothesis.missed;
    }
    const double fitness = global_.fitness(query.features, hypothesis.pose.T_a_b) *
                           std::max(0.3, 1.0 - results[i].violations);
    hypothesis.weight *= geometry::exp(kSharpness * (fitness - kElsewhereFitness));
    sum += hypothesis.weight;
  }
  for (Hypothesis& hypothesis : hypotheses_) hypothesis.weight /= sum;
  std::stable_sort(hypotheses_.begin(), hypotheses_.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.weight > b.weight; });
  // Two that have come to the same place are one.
  std::vector<Hypothesis> kept;
  for (const Hypothesis& hypothesis : hypotheses_) {
    const auto same = std::find_if(kept.begin(), kept.end(), [&](const Hypothesis& other) {
      return same_hypothesis(other.pose.T_a_b, hypothesis.pose.T_a_b);
    });
    if (same != kept.end()) {
      same->weight += hypothesis.weight;
      if (hypothesis.seen > same->seen) {
        same->seen = hypothesis.seen;
        same->way_m = hypothesis.way_m;
      }
      same->wanted = std::min(same->wanted, hypothesis.wanted);
    } else if (hypothesis.weight >= kForgotten && hypothesis.missed < kMissedOften &&
               kept.size() < kMostHypotheses) {
      kept.push_back(hypothesis);
    }
  }
  hypotheses_ = std::move(kept);
}

// Takes the pose of the one place that is left, or says how it stands.
void MapLocalizer::decide() {
  belief_ = {LocalizationState::kSearching, 0.0};
  if (hypotheses_.empty()) return;
  const auto best = std::max_element(
      hypotheses_.begin(), hypotheses_.end(),
      [](const Hypothesis& a, const Hypothesis& b) { return a.weight < b.weight; });
  pose_ = best->pose;
  const double confidence = best->weight * covariance_confidence(pose_.covariance);
  belief_.confidence = confidence;
  if (best->seen > 0 && best->weight >= 0.5) {
    belief_.state = LocalizationState::kAmbiguous;
    believed_ = best->missed == 0 ? 1 : 0;
  }
  if (best->weight < kSure || best->seen < best->wanted || best->missed > 0 ||
      best->way_m < kLeastWay_m) {
    return;
  }
  has_pose_ = true;
  StepEvidence evidence;
  evidence.points = kFewestSearched;
  evidence.covariance = pose_.covariance;
  monitor_.restart(best->weight);
  belief_ = monitor_.add(evidence);
  hypotheses_.clear();
}

}  // namespace topogeo::localization
