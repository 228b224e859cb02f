#include "loop/loop_agreement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "topogeo/slam/loop/loop_config.hpp"
#include "topogeo/slam/loop/loop_decision.hpp"
#include "topogeo/slam/place_recognition.hpp"

#include "covariance_calibration.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

using PairLimits = LoopAgreementLimits;
using Weights = AgreementWeights;

// Weight of a window for each metre of path that only it contains: a full window weighs as much as
// the most that a stop does.
constexpr double kShareOfWindow = Weights::kMostShare / PlaceRecognition::kQuery_m;

/// Whether the path between two stops is too long for odometry.
bool far_apart(std::span<const double> path_m, std::uint32_t a, std::uint32_t b) {
  return std::fabs(path_m[a] - path_m[b]) > PairLimits::kFarthest_m;
}

/// Distance by which the round trip over two loops misses its start, metres.
double off_by_way_of(const PoseGraph& graph, const PoseGraphEdge& a, const PoseGraphEdge& b) {
  const std::vector<Pose2>& poses = graph.poses();
  const Pose2 T_around = geometry::between(poses[b.from], poses[a.from]) * a.T_from_to *
                         geometry::between(poses[a.to], poses[b.to]);
  return (T_around.position_m() - b.T_from_to.position_m()).norm();
}

}  // namespace

double disagreement(const PoseGraph& graph, const PoseGraphEdge& a, const PoseGraphEdge& b,
                    std::span<const double> path_m, double farthest_m) {
  if (std::fabs(path_m[a.to] - path_m[b.to]) > farthest_m ||
      std::fabs(path_m[a.from] - path_m[b.from]) > farthest_m) {
    return std::numeric_limits<double>::infinity();
  }
  // Most pairs are far from agreement, which is visible without covariances.
  if (off_by_way_of(graph, a, b) > PairLimits::kFarOff_m)
    return std::numeric_limits<double>::infinity();
  return disagreement(graph, a, b, graph.along_path(b.from, a.from));
}

double disagreement(const PoseGraph& graph, const PoseGraphEdge& a, const PoseGraphEdge& b,
                    const UncertainPose& T_from_b_from_a) {
  // b through a: b.from -> a.from -> a.to -> b.to.
  const UncertainPose by_a = compose(compose(T_from_b_from_a, {a.T_from_to, a.for_predictions()}),
                                     graph.along_path(a.to, b.to));
  return geometry::squared_mahalanobis(geometry::difference(by_a.T_a_b, b.T_from_to),
                                       by_a.covariance + b.for_predictions() + map_noise());
}

void LoopAgreement::add(const StopMatch& match, std::span<const double> path_m) {
  keep({match, match.accepted() ? Weights::kPassed : Weights::kDoubtful, true, false}, path_m);
}

void LoopAgreement::add_accepted(const StopMatch& match, std::span<const double> path_m) {
  keep({match, Weights::kPassed, false, true}, path_m);
}

void LoopAgreement::keep(Hypothesis hypothesis, std::span<const double> path_m) {
  const PoseGraphEdge& edge = hypothesis.match.edge;
  std::erase_if(hypotheses_, [&](const Hypothesis& h) {
    return (h.match.edge.from == edge.from && h.match.edge.to == edge.to) ||
           path_m[edge.to] - path_m[h.match.edge.to] > PairLimits::kForgotten_m;
  });
  hypotheses_.push_back(std::move(hypothesis));
}

double LoopAgreement::disagreement(std::size_t a, std::size_t b, const Ways& ways) const {
  const PoseGraphEdge& first = edge_of(a);
  const PoseGraphEdge& second = edge_of(b);
  if (!far_apart(ways.path_m, first.from, second.from)) {
    return localization::disagreement(ways.graph, first, second, ways.path_m,
                                      PairLimits::kFarthest_m);
  }
  const UncertainPose* const T_seed_first = ways.T_seed_stop.find(first.from);
  const UncertainPose* const T_seed_second = ways.T_seed_stop.find(second.from);
  constexpr double kNone = std::numeric_limits<double>::infinity();
  if (T_seed_first == nullptr || T_seed_second == nullptr) return kNone;
  if (far_apart(ways.path_m, first.to, second.to)) return kNone;
  const UncertainPose T_second_first = compose(inverse(*T_seed_second), *T_seed_first);
  if (!well_known(T_second_first.covariance)) return kNone;
  return localization::disagreement(ways.graph, first, second, T_second_first);
}

// Earlier ends of the loops that may agree with this one; empty if all are of its visit, or
// together could not weigh enough.
std::vector<std::uint32_t> LoopAgreement::other_visits(std::size_t seed, const Ways& ways) const {
  const PoseGraphEdge& seed_edge = edge_of(seed);
  Set near;
  bool others = false;
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    const PoseGraphEdge& edge = edge_of(i);
    if (far_apart(ways.path_m, edge.to, seed_edge.to) ||
        off_by_way_of(ways.graph, edge, seed_edge) > PairLimits::kFarOff_m) {
      continue;
    }
    near.push_back(i);
    others |= far_apart(ways.path_m, edge.from, seed_edge.from);
  }
  std::vector<std::uint32_t> stops;
  if (!others || weight_of(near, ways.path_m) < Weights::kWantedOfLoop) return stops;
  for (const std::size_t i : near) stops.push_back(edge_of(i).from);
  std::sort(stops.begin(), stops.end());
  stops.erase(std::unique(stops.begin(), stops.end()), stops.end());
  return stops;
}

// Greedily: the heaviest and newest first.
LoopAgreement::Set LoopAgreement::set_around(std::size_t seed, std::span<const std::size_t> among,
                                             const Ways& ways) const {
  struct Partner {
    std::size_t index;
    double weight;
    double disagreement;
  };
  std::vector<Partner> partners;
  for (const std::size_t i : among) {
    if (i == seed) continue;
    const double apart = disagreement(i, seed, ways);
    if (apart <= PairLimits::kAgree2) partners.push_back({i, hypotheses_[i].weight, apart});
  }
  std::stable_sort(partners.begin(), partners.end(), [](const Partner& a, const Partner& b) {
    return a.weight != b.weight ? a.weight > b.weight : a.disagreement < b.disagreement;
  });
  Set set{seed};
  for (const Partner& partner : partners) {
    const bool all = std::all_of(set.begin() + 1, set.end(), [&](std::size_t other) {
      return disagreement(partner.index, other, ways) <= PairLimits::kAgree2;
    });
    if (all) set.push_back(partner.index);
  }
  std::sort(set.begin(), set.end());
  return set;
}

// Sums the best match of each later stop, weighted by the distance from the previous one, because
// the view of one stop is one piece of evidence. Windows of successive stops contain nearly the
// same views, so each counts by the path that no window before it contains.
double LoopAgreement::weight_of(const Set& set, std::span<const double> path_m) const {
  struct Evidence {
    double stop = 0.0;
    double window = 0.0;
    std::uint32_t first_of_window = 0;
  };
  std::map<std::uint32_t, Evidence> of_stop;
  for (const std::size_t i : set) {
    const StopMatch& match = hypotheses_[i].match;
    Evidence& evidence = of_stop[match.edge.to];
    if (match.source == ProposalSource::kWindow) {
      evidence.window = std::max(evidence.window, hypotheses_[i].weight);
      evidence.first_of_window = match.first_of_window;
    } else {
      evidence.stop = std::max(evidence.stop, hypotheses_[i].weight);
    }
  }
  double sum = 0.0;
  std::optional<double> before_m;
  double windows_until_m = path_m.front();
  for (const auto& [stop, evidence] : of_stop) {
    const double apart_m = before_m ? path_m[stop] - *before_m : Weights::kCountedApart_m;
    before_m = path_m[stop];
    const double share =
        std::clamp(apart_m / Weights::kCountedApart_m, Weights::kLeastShare, Weights::kMostShare);
    double window = 0.0;
    if (evidence.window > 0.0) {
      const double from_m = std::max(windows_until_m, path_m[evidence.first_of_window]);
      windows_until_m = path_m[stop];
      window = evidence.window * kShareOfWindow * (path_m[stop] - from_m);
    }
    sum += std::max(evidence.stop * share, window);
  }
  return sum;
}

// Surprise of the match that contradicts the prediction least: all of a set state the same.
double LoopAgreement::surprise_of(const Set& set) const {
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : set) least = std::min(least, hypotheses_[i].match.surprise());
  return least;
}

bool LoopAgreement::spread(const Set& set, std::span<const double> path_m) const {
  double low_m = std::numeric_limits<double>::infinity();
  double high_m = -low_m;
  for (const std::size_t i : set) {
    low_m = std::min(low_m, path_m[hypotheses_[i].match.edge.to]);
    high_m = std::max(high_m, path_m[hypotheses_[i].match.edge.to]);
  }
  return high_m - low_m >= Weights::kLeastSpread_m;
}

bool LoopAgreement::is_heavy(const Set& set, std::span<const double> path_m) const {
  const double wanted =
      Weights::kWantedOfLoop + Weights::kPerSurprise * std::log1p(surprise_of(set));
  return weight_of(set, path_m) >= wanted && spread(set, path_m);
}

// Hypotheses for the same later stretch that put the robot elsewhere. A loop with another earlier
// visit of the place is not automatically one: the graph predicts the pose of that visit, so it
// must contradict the set by more than the set surprises the graph. That surprise is charged
// already, in the required weight.
LoopAgreement::Set LoopAgreement::rivals_of(std::size_t seed, const Set& set,
                                            const Ways& ways) const {
  const std::span<const double> path_m = ways.path_m;
  const PoseGraphEdge& seed_edge = edge_of(seed);
  const auto of_one_visit = [&](std::size_t i) {
    return !far_apart(path_m, edge_of(i).from, seed_edge.from);
  };
  Set others;
  std::set<std::uint32_t> of_other_visits;
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    if (std::binary_search(set.begin(), set.end(), i) ||
        far_apart(path_m, edge_of(i).to, seed_edge.to)) {
      continue;
    }
    const bool agrees = std::any_of(set.begin(), set.end(), [&](std::size_t other) {
      return disagreement(i, other, ways) <= PairLimits::kAgree2;
    });
    if (agrees) continue;
    others.push_back(i);
    if (!of_one_visit(i)) of_other_visits.insert(edge_of(i).from);
  }
  for (const std::size_t i : set) {
    if (!of_one_visit(i)) of_other_visits.insert(edge_of(i).from);
  }
  const RelativePoses T_seed_stop = ways.graph.predict_from(
      seed_edge.from, std::vector<std::uint32_t>(of_other_visits.begin(), of_other_visits.end()));
  const double surprise = surprise_of(set);
  const auto elsewhere = [&](std::size_t i) {
    if (of_one_visit(i)) return true;
    const auto later_apart_m = [&](std::size_t other) {
      return std::fabs(path_m[edge_of(other).to] - path_m[edge_of(i).to]);
    };
    const PoseGraphEdge& nearest =
        edge_of(*std::min_element(set.begin(), set.end(), [&](std::size_t a, std::size_t b) {
          return later_apart_m(a) < later_apart_m(b);
        }));
    const UncertainPose T_seed_nearest = far_apart(path_m, nearest.from, seed_edge.from)
                                             ? T_seed_stop.at(nearest.from)
                                             : ways.graph.along_path(seed_edge.from, nearest.from);
    const UncertainPose T_from_nearest =
        compose(inverse(T_seed_stop.at(edge_of(i).from)), T_seed_nearest);
    return localization::disagreement(ways.graph, nearest, edge_of(i), T_from_nearest) >
           PairLimits::kAgree2 + surprise;
  };
  std::erase_if(others, [&](std::size_t i) { return !elsewhere(i); });
  return others;
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
      Ways ways{graph, path_m};
      Set set = set_around(seed, all, ways);
      if (!is_heavy(set, path_m)) {
        const std::vector<std::uint32_t> visits = other_visits(seed, ways);
        if (visits.empty()) continue;
        ways.T_seed_stop = graph.predict_from(edge_of(seed).from, visits, PoseGraph::kUnlimited,
                                              PoseGraph::kMostVisited);
        set = set_around(seed, all, ways);
        if (!is_heavy(set, path_m)) continue;
      }
      const double weight = weight_of(set, path_m);
      std::vector<std::size_t> rivals = rivals_of(seed, set, ways);
      double rival = 0.0;
      std::stable_sort(rivals.begin(), rivals.end(), [&](std::size_t a, std::size_t b) {
        return hypotheses_[a].weight > hypotheses_[b].weight;
      });
      for (std::size_t k = 0; k < std::min(PairLimits::kRivalSeeds, rivals.size()); ++k) {
        rival = std::max(rival, weight_of(set_around(rivals[k], rivals, ways), path_m));
      }
      if (weight < Weights::kOverRival * rival) continue;
      const bool as_predicted = surprise_of(set) <= PairLimits::kMostSurprise2;
      for (const std::size_t i : set) {
        // Matches that slid along a corridor agree with the others, but not with the prediction
        // that the others agree with. Windows slide most easily: if they move nothing, stops are
        // more accurate.
        StopMatch match = hypotheses_[i].match;
        match.agreement = weight;
        match.rival_agreement = rival;
        if (as_predicted &&
            (match.source == ProposalSource::kWindow ||
             match.surprise() > PairLimits::kMostSurprise2 ||
             loop_probability(match.loop_evidence()) < PairLimits::kLeastProbability)) {
          continue;
        }
        if (!hypotheses_[i].accepted) out.push_back(std::move(match));
        hypotheses_[i].accepted = true;
        hypotheses_[i].weight = Weights::kPassed;
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
