#include "place_search.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"

#include "pose_fusion.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// These depend on each other, so none is a setting; tests/bench/kidnapped.cpp measures their
// combined effect.
constexpr std::size_t kMostHypotheses = 16;
constexpr double kProposed_m = 0.25;  // deviation of a proposed place: the cells of the search
constexpr double kProposed_rad = 0.08;
constexpr double kSharpness = 25.0;         // of the weights by fitness: e^2.5 per 0.1
constexpr double kIndependent_m = 1.0;      // path between two stops with independent views
constexpr double kElsewhereFitness = 0.60;  // best fitness if the robot is somewhere else
constexpr double kElsewhereWeight = 0.5;    // weight of elsewhere at the start
constexpr double kNewWeight = 0.05;         // of a place without earlier evidence
constexpr double kForgotten = 1e-4;
constexpr double kSure = 0.95;
constexpr double kSurer = 0.99;  // for a place proved only by the agreement of its stops
// Required mean fitness: if another building or a piece of corridor looks like the place, about 0.6
// of the view is there.
constexpr double kSurelyThere = 0.70;
constexpr std::uint32_t kSeenOften = 2;  // accepted matches before a place is taken
// Required if earlier stops of this search did not support the place.
constexpr std::uint32_t kSeenMoreOften = 4;
constexpr double kLeastDistance_m = 0.3;  // between the first and the last of them
constexpr std::uint32_t kMissedOften = 3;
constexpr std::uint32_t kCarriedAccepted = 10;  // for a place to which the drive does not lead
// Two nearer poses are one hypothesis.
constexpr double kHypothesesApart_m = 0.6;
constexpr double kHypothesesApart_rad = 0.3;

bool same_hypothesis(const Pose2& a, const Pose2& b) {
  return (a.position_m() - b.position_m()).squaredNorm() <
             kHypothesesApart_m * kHypothesesApart_m &&
         std::fabs(geometry::wrap_angle(a.theta_rad - b.theta_rad)) < kHypothesesApart_rad;
}

}  // namespace

void PlaceSearch::begin() {
  hypotheses_.clear();
  stops_ = 0;
  moved_m_ = kIndependent_m;
}

void PlaceSearch::move(const UncertainPose& odometry, double distance_m) {
  for (PlaceHypothesis& hypothesis : hypotheses_) {
    hypothesis.pose = {
        hypothesis.pose.T_a_b * odometry.T_a_b,
        geometry::compose_covariance(hypothesis.pose.T_a_b, hypothesis.pose.covariance,
                                     odometry.T_a_b, odometry.covariance)};
    hypothesis.distance_m += distance_m;
    hypothesis.agreement.move(distance_m);
  }
  moved_m_ += distance_m;
}

void PlaceSearch::propose(std::span<const Pose2> T_map_robot) {
  for (const Pose2& place : T_map_robot) {
    const bool known =
        std::any_of(hypotheses_.begin(), hypotheses_.end(),
                    [&](const PlaceHypothesis& h) { return same_hypothesis(h.pose.T_a_b, place); });
    if (known) continue;
    PlaceHypothesis hypothesis;
    hypothesis.pose = {place, Eigen::Vector3d(kProposed_m * kProposed_m, kProposed_m * kProposed_m,
                                              kProposed_rad * kProposed_rad)
                                  .asDiagonal()};
    hypothesis.weight = kNewWeight;
    hypothesis.wanted = std::min(kSeenMoreOften, kSeenOften + stops_);
    hypotheses_.push_back(hypothesis);
  }
}

void PlaceSearch::expect(const Pose2& T_map_robot) {
  propose({&T_map_robot, 1});
  for (PlaceHypothesis& h : hypotheses_) {
    if (same_hypothesis(h.pose.T_a_b, T_map_robot)) h.wanted = kSeenOften;
  }
}

void PlaceSearch::observe(std::size_t index, const std::optional<Observation>& measured) {
  PlaceHypothesis& hypothesis = hypotheses_.at(index);
  if (!measured) {
    ++hypothesis.missed;
    hypothesis.agreement.contradict();
    return;
  }
  const UncertainPose& pose = measured->T_map_robot;
  hypothesis.pose = hypothesis.seen == 0 ? pose : fused({hypothesis.pose, pose});
  if (hypothesis.seen == 0) hypothesis.distance_m = 0.0;
  ++hypothesis.seen;
  if (measured->accepted) ++hypothesis.accepted;
  hypothesis.agreement.add(measured->accepted, measured->confidence);
  hypothesis.missed = 0;
}

void PlaceSearch::weigh(std::span<const double> fitness) {
  if (fitness.size() != hypotheses_.size()) {
    throw std::invalid_argument("place search: " + std::to_string(fitness.size()) +
                                " fitness values for " + std::to_string(hypotheses_.size()) +
                                " hypotheses");
  }
  double elsewhere = kElsewhereWeight;
  for (const PlaceHypothesis& hypothesis : hypotheses_) elsewhere -= hypothesis.weight;
  elsewhere = std::max(kNewWeight, elsewhere);
  double sum = elsewhere;
  const double sharpness = kSharpness * std::min(1.0, moved_m_ / kIndependent_m);
  moved_m_ = 0.0;
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    PlaceHypothesis& hypothesis = hypotheses_[i];
    if (hypothesis.missed == 0 && hypothesis.seen > 0) {
      hypothesis.fitness += (fitness[i] - hypothesis.fitness) / hypothesis.seen;
    }
    hypothesis.weight *= geometry::exp(sharpness * (fitness[i] - kElsewhereFitness));
    sum += hypotheses_[i].weight;
  }
  for (PlaceHypothesis& hypothesis : hypotheses_) hypothesis.weight /= sum;
  std::stable_sort(
      hypotheses_.begin(), hypotheses_.end(),
      [](const PlaceHypothesis& a, const PlaceHypothesis& b) { return a.weight > b.weight; });
  merge();
}

// Merges hypotheses that have reached the same place.
void PlaceSearch::merge() {
  std::vector<PlaceHypothesis> kept;
  for (const PlaceHypothesis& hypothesis : hypotheses_) {
    const auto same = std::find_if(kept.begin(), kept.end(), [&](const PlaceHypothesis& other) {
      return same_hypothesis(other.pose.T_a_b, hypothesis.pose.T_a_b);
    });
    if (same != kept.end()) {
      same->weight += hypothesis.weight;
      if (hypothesis.seen > same->seen) {
        same->seen = hypothesis.seen;
        same->accepted = hypothesis.accepted;
        same->agreement = hypothesis.agreement;
        same->fitness = hypothesis.fitness;
        same->distance_m = hypothesis.distance_m;
      }
      same->wanted = std::min(same->wanted, hypothesis.wanted);
    } else if (hypothesis.weight >= kForgotten && hypothesis.missed < kMissedOften &&
               kept.size() < kMostHypotheses) {
      kept.push_back(hypothesis);
    }
  }
  hypotheses_ = std::move(kept);
}

std::optional<PlaceHypothesis> PlaceSearch::best() const {
  const auto best = std::max_element(
      hypotheses_.begin(), hypotheses_.end(),
      [](const PlaceHypothesis& a, const PlaceHypothesis& b) { return a.weight < b.weight; });
  if (best == hypotheses_.end()) return std::nullopt;
  return *best;
}

bool PlaceSearch::found(const PlaceHypothesis& hypothesis, double carried_m) {
  if (hypothesis.missed > 0 || hypothesis.fitness < kSurelyThere) return false;
  if (carried_m > 0.0 &&
      (hypothesis.accepted < kCarriedAccepted || hypothesis.distance_m < carried_m)) {
    return false;
  }
  const bool accepted = hypothesis.weight >= kSure && hypothesis.accepted >= hypothesis.wanted &&
                        hypothesis.distance_m >= kLeastDistance_m;
  return accepted || (hypothesis.weight >= kSurer && hypothesis.agreement.enough());
}

}  // namespace topogeo::localization
