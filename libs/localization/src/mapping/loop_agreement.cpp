#include "topogeo/localization/mapping/loop_agreement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "topogeo/localization/mapping/covariance_calibration.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// Over a longer path odometry says too little to call two loops contradictory.
constexpr double kFarthest_m = 25.0;
constexpr double kFarOff_m = 5.0;  // ways round two loops that agree end nearer to each other
constexpr double kAgree = 7.8;     // 95 % of right pairs (chi-square, three degrees of freedom)
// Weights: of a match that passed its gate and of a doubtful one; of a set that is accepted, and
// how much heavier than its rivals that has to be.
constexpr double kPassed = 1.5;
constexpr double kDoubtful = 1.0;
// A match where the coarse search found the place says less than one where it was predicted.
constexpr double kOfPlace = 0.75;
constexpr double kLeastWeight = 4.0;
// More is wanted of a set that the prediction speaks against: per logarithm of the squared
// Mahalanobis distance, because a prediction is wrong by far more often than a Gaussian says.
constexpr double kPerSurprise = 0.75;
constexpr double kOverRival = 2.0;
constexpr double kLeastSpread_m = 2.0;
constexpr std::size_t kRivalSeeds = 8;
// Older ones have had their chance: bounds the work of a step.
constexpr double kForgotten_m = 60.0;

}  // namespace

double disagreement(const PoseGraph& graph, const PoseGraphEdge& a, const PoseGraphEdge& b,
                    std::span<const double> path_m, double farthest_m) {
  if (std::fabs(path_m[a.to] - path_m[b.to]) > farthest_m ||
      std::fabs(path_m[a.from] - path_m[b.from]) > farthest_m) {
    return std::numeric_limits<double>::infinity();
  }
  // Most pairs are far from agreeing: seen without covariances.
  const std::vector<geometry::Pose2>& poses = graph.poses();
  const geometry::Pose2 T_around = geometry::between(poses[b.from], poses[a.from]) * a.T_from_to *
                                   geometry::between(poses[a.to], poses[b.to]);
  if ((T_around.position_m() - b.T_from_to.position_m()).squaredNorm() > kFarOff_m * kFarOff_m) {
    return std::numeric_limits<double>::infinity();
  }
  // b by way of a: b.from -> a.from -> a.to -> b.to.
  const UncertainPose by_a =
      compose(compose(graph.along_path(b.from, a.from), {a.T_from_to, a.for_predictions()}),
              graph.along_path(a.to, b.to));
  return geometry::squared_mahalanobis(geometry::difference(by_a.T_a_b, b.T_from_to),
                                       by_a.covariance + b.for_predictions() + map_noise());
}

void LoopAgreement::add(const StopMatch& match, std::span<const double> path_m) {
  const double weight = match.accepted() ? kPassed : kDoubtful;
  keep({match, match.source == ProposalSource::kPlace ? kOfPlace * weight : weight, true, false},
       path_m);
}

void LoopAgreement::add_accepted(const StopMatch& match, std::span<const double> path_m) {
  keep({match, kPassed, false, true}, path_m);
}

void LoopAgreement::keep(Hypothesis hypothesis, std::span<const double> path_m) {
  const PoseGraphEdge& edge = hypothesis.match.edge;
  std::erase_if(hypotheses_, [&](const Hypothesis& h) {
    return (h.match.edge.from == edge.from && h.match.edge.to == edge.to) ||
           path_m[edge.to] - path_m[h.match.edge.to] > kForgotten_m;
  });
  hypotheses_.push_back(std::move(hypothesis));
}

// Greedily: the heaviest and newest first.
LoopAgreement::Set LoopAgreement::set_around(std::size_t seed, std::span<const std::size_t> among,
                                             const PoseGraph& graph,
                                             std::span<const double> path_m) const {
  struct Partner {
    std::size_t index;
    double weight;
    double disagreement;
  };
  const PoseGraphEdge& seed_edge = hypotheses_[seed].match.edge;
  std::vector<Partner> partners;
  for (const std::size_t i : among) {
    if (i == seed) continue;
    const double apart =
        disagreement(graph, hypotheses_[i].match.edge, seed_edge, path_m, kFarthest_m);
    if (apart <= kAgree) partners.push_back({i, hypotheses_[i].weight, apart});
  }
  std::stable_sort(partners.begin(), partners.end(), [](const Partner& a, const Partner& b) {
    return a.weight != b.weight ? a.weight > b.weight : a.disagreement < b.disagreement;
  });
  Set set{seed};
  for (const Partner& partner : partners) {
    const bool all = std::all_of(set.begin() + 1, set.end(), [&](std::size_t other) {
      return disagreement(graph, hypotheses_[partner.index].match.edge,
                          hypotheses_[other].match.edge, path_m, kFarthest_m) <= kAgree;
    });
    if (all) set.push_back(partner.index);
  }
  std::sort(set.begin(), set.end());
  return set;
}

// The best of each later stop: what one stop sees is one piece of evidence.
double LoopAgreement::weight_of(const Set& set) const {
  std::map<std::uint32_t, double> of_stop;
  for (const std::size_t i : set) {
    double& weight = of_stop[hypotheses_[i].match.edge.to];
    weight = std::max(weight, hypotheses_[i].weight);
  }
  double sum = 0.0;
  for (const auto& [stop, weight] : of_stop) sum += weight;
  return sum;
}

bool LoopAgreement::spread(const Set& set, std::span<const double> path_m) const {
  double low_m = std::numeric_limits<double>::infinity();
  double high_m = -low_m;
  for (const std::size_t i : set) {
    low_m = std::min(low_m, path_m[hypotheses_[i].match.edge.to]);
    high_m = std::max(high_m, path_m[hypotheses_[i].match.edge.to]);
  }
  return high_m - low_m >= kLeastSpread_m;
}

std::vector<StopMatch> LoopAgreement::accepted(const PoseGraph& graph,
                                               std::span<const double> path_m) {
  std::vector<StopMatch> out;
  for (bool again = true; again;) {
    again = false;
    for (std::size_t seed = 0; seed < hypotheses_.size() && !again; ++seed) {
      if (!hypotheses_[seed].fresh) continue;
      hypotheses_[seed].fresh = false;
      std::vector<std::size_t> all(hypotheses_.size());
      for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
      const Set set = set_around(seed, all, graph, path_m);
      const double weight = weight_of(set);
      const double wanted =
          kLeastWeight + kPerSurprise * std::log1p(hypotheses_[seed].match.surprise());
      if (weight < wanted || !spread(set, path_m)) continue;
      // Those of the same stretch that say something else.
      const double at_m = path_m[hypotheses_[seed].match.edge.to];
      std::vector<std::size_t> rivals;
      for (const std::size_t i : all) {
        if (std::binary_search(set.begin(), set.end(), i) ||
            std::fabs(path_m[hypotheses_[i].match.edge.to] - at_m) > kFarthest_m) {
          continue;
        }
        const bool agrees = std::any_of(set.begin(), set.end(), [&](std::size_t other) {
          return disagreement(graph, hypotheses_[i].match.edge, hypotheses_[other].match.edge,
                              path_m, kFarthest_m) <= kAgree;
        });
        if (!agrees) rivals.push_back(i);
      }
      double rival = 0.0;
      std::stable_sort(rivals.begin(), rivals.end(), [&](std::size_t a, std::size_t b) {
        return hypotheses_[a].weight > hypotheses_[b].weight;
      });
      for (std::size_t k = 0; k < std::min(kRivalSeeds, rivals.size()); ++k) {
        rival = std::max(rival, weight_of(set_around(rivals[k], rivals, graph, path_m)));
      }
      if (weight < kOverRival * rival) continue;
      for (const std::size_t i : set) {
        if (!hypotheses_[i].accepted) out.push_back(hypotheses_[i].match);
        hypotheses_[i].accepted = true;
        hypotheses_[i].weight = kPassed;
      }
      std::vector<std::size_t> gone;
      for (const std::size_t i : rivals) {
        if (!hypotheses_[i].accepted) gone.push_back(i);
      }
      std::sort(gone.begin(), gone.end());
      for (std::size_t k = gone.size(); k-- > 0;) {
        hypotheses_.erase(hypotheses_.begin() + static_cast<std::ptrdiff_t>(gone[k]));
      }
      again = true;
    }
  }
  return out;
}

}  // namespace topogeo::localization
