#include "topogeo/thesis/kept_solutions.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "topogeo/matching/match_features.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// Nearly as much as one pair of maps that lie on each other: less is no evidence for a cycle.
constexpr double kLeastAgreement = 0.9;
// A pair that agrees less than this does not show that the robot is in a known zone.
constexpr double kLeastPairFitness = 0.05;
// The joint refinement: grids of a few steps to each side, at half the step in each round.
constexpr double kFirstStep_m = 0.10;
constexpr double kFirstStep_rad = 0.0175;
constexpr int kStepsAside = 2;
constexpr int kStepsOfTurn = 3;
constexpr int kRounds = 4;
constexpr int kMovesPerRound = 6;
// Farther away it would be another solution.
constexpr double kLargestShift_m = 1.0;
constexpr double kLargestTurn_rad = 0.15;

/// The robot poses `later` of a pair, fixed to each other, and the pair's fitness.
struct JointPair {
  Pose2 T_map_earlier;
  Pose2 T_pivot_later;
  WeightedFitness fitness;
};

double joint_fitness(const std::vector<JointPair>& pairs, const Pose2& T_map_pivot) {
  double sum = 0.0;
  for (const JointPair& pair : pairs) {
    const Pose2 T = geometry::between(pair.T_map_earlier, T_map_pivot * pair.T_pivot_later);
    sum += pair.fitness.of_maps(T, geometry::sincos(T.theta_rad));
  }
  return sum;
}

/// The shift of the pivot, in its own frame, with the largest joint fitness near none.
Pose2 best_shift(const std::vector<JointPair>& pairs, const Pose2& T_map_pivot) {
  Pose2 best;
  double most = joint_fitness(pairs, T_map_pivot);
  double step_m = kFirstStep_m;
  double step_rad = kFirstStep_rad;
  for (int round = 0; round < kRounds; ++round, step_m *= 0.5, step_rad *= 0.5) {
    for (int move = 0; move < kMovesPerRound; ++move) {
      const Pose2 from = best;
      for (int x = -kStepsAside; x <= kStepsAside; ++x) {
        for (int y = -kStepsAside; y <= kStepsAside; ++y) {
          for (int turn = -kStepsOfTurn; turn <= kStepsOfTurn; ++turn) {
            const Pose2 shift{from.x_m + x * step_m, from.y_m + y * step_m,
                              from.theta_rad + turn * step_rad};
            const bool near = std::fabs(shift.theta_rad) <= kLargestTurn_rad &&
                              shift.position_m().squaredNorm() <= kLargestShift_m * kLargestShift_m;
            if (!near) continue;
            const double fitness = joint_fitness(pairs, T_map_pivot * shift);
            if (fitness <= most + 1e-9) continue;
            most = fitness;
            best = shift;
          }
        }
      }
      if (best == from) break;
    }
  }
  return best;
}

}  // namespace

KeptSolutions::KeptSolutions(const ThesisSlamConfig& config) : config_(config) {
  task_.covariance = Eigen::Matrix3d::Identity();
  task_.half_width = Eigen::Vector3d::Ones();
}

void KeptSolutions::add_stop(const ThesisMap& map) {
  const auto stop = static_cast<std::uint32_t>(map.size() - 1);
  topomap::LocalMap seen = *map.stop(stop).map;
  seen.points = points_for(seen, config_.evidence);
  features_.push_back(std::make_shared<const MatchFeatures>(extract_features(seen)));
  references_.emplace_back();
  remake_reference(features_.back(), references_.back());
  if (stop == 0) return;
  const Pose2 T_previous_this = geometry::between(map.poses()[stop - 1], map.poses()[stop]);
  for (CycleSolution& solution : kept_) {
    solution.T_map_stop.push_back(solution.T_map_stop.back() * T_previous_this);
    solution.agreement += agreement_of_stop(map, solution, stop);
  }
  rank();
}

double KeptSolutions::fitness(const ThesisMap& map, const CycleSolution& solution, Pair pair) {
  const Pose2 T =
      geometry::between(solution.T_map_stop[pair.earlier], solution.T_map_stop[pair.later]);
  const topomap::VisibleRectangle seen =
      seen_from(map.stop(pair.later).view, T, Eigen::Vector3d::Zero());
  if (!overlap(seen, map.stop(pair.earlier).view)) return 0.0;
  fitness_.bind(references_[pair.earlier], *features_[pair.later], task_);
  return fitness_.of_maps(T, geometry::sincos(T.theta_rad));
}

double KeptSolutions::agreement_of_stop(const ThesisMap& map, const CycleSolution& solution,
                                        std::uint32_t later) {
  double sum = 0.0;
  for (std::uint32_t earlier = 0; earlier < later && !map.recent(earlier, later); ++earlier) {
    sum += fitness(map, solution, {earlier, later});
  }
  return sum;
}

void KeptSolutions::offer(const ThesisMap& map, std::vector<CycleSolution> found) {
  for (CycleSolution& solution : found) {
    solution.agreement = 0.0;
    for (std::uint32_t later = 1; later < solution.T_map_stop.size(); ++later) {
      solution.agreement += agreement_of_stop(map, solution, later);
    }
    kept_.push_back(std::move(solution));
  }
  rank();
}

// Best first, without those at whose last pose a better one already is.
void KeptSolutions::rank() {
  std::stable_sort(kept_.begin(), kept_.end(), [](const CycleSolution& a, const CycleSolution& b) {
    return a.agreement > b.agreement;
  });
  std::vector<CycleSolution> distinct;
  for (CycleSolution& solution : kept_) {
    if (distinct.size() == config_.thesis.kept_solutions) break;
    const bool known = std::ranges::any_of(distinct, [&](const CycleSolution& better) {
      const Eigen::Vector3d off =
          geometry::difference(better.T_map_stop.back(), solution.T_map_stop.back());
      return off.head<2>().norm() < config_.genetic.resolution_m &&
             std::fabs(off.z()) < config_.genetic.resolution_rad;
    });
    if (!known) distinct.push_back(std::move(solution));
  }
  kept_ = std::move(distinct);
}

void KeptSolutions::refine(const ThesisMap& map) {
  if (kept_.empty()) return;
  const std::vector<UncertainPose> T_first_stop = map.relative_to(0);
  for (CycleSolution& solution : kept_) refine_one(map, solution, T_first_stop);
  std::stable_sort(kept_.begin(), kept_.end(), [](const CycleSolution& a, const CycleSolution& b) {
    return a.agreement > b.agreement;
  });
}

void KeptSolutions::refine_one(const ThesisMap& map, CycleSolution& solution,
                               const std::vector<UncertainPose>& T_first_stop) {
  const auto stops = static_cast<std::uint32_t>(solution.T_map_stop.size());
  const auto in_known_zone = [&](std::uint32_t later) {
    for (std::uint32_t earlier = 0; earlier < later && !map.recent(earlier, later); ++earlier) {
      if (fitness(map, solution, {earlier, later}) > kLeastPairFitness) return true;
    }
    return false;
  };
  std::uint32_t first = 1;
  while (first < stops && !in_known_zone(first)) ++first;
  solution.agreement = 0.0;
  if (first >= stops) return;
  const Pose2 T_map_pivot = solution.T_map_stop.back();
  const Eigen::Vector3d reach(3.0 * kFirstStep_m, 3.0 * kFirstStep_m, 0.1);
  std::vector<Pair> near;
  for (std::uint32_t later = first; later < stops; ++later) {
    for (std::uint32_t earlier = 0; earlier < first && !map.recent(earlier, later); ++earlier) {
      const double sigma_rad = std::sqrt(T_first_stop[earlier].covariance(2, 2));
      if (sigma_rad > config_.genetic.resolution_rad) continue;
      const Pose2 T = geometry::between(solution.T_map_stop[earlier], solution.T_map_stop[later]);
      const topomap::VisibleRectangle seen = seen_from(map.stop(later).view, T, reach);
      if (overlap(seen, map.stop(earlier).view)) near.push_back({earlier, later});
    }
  }
  std::vector<JointPair> pairs(near.size());
  for (std::size_t i = 0; i < near.size(); ++i) {
    pairs[i].T_map_earlier = solution.T_map_stop[near[i].earlier];
    pairs[i].T_pivot_later = geometry::between(T_map_pivot, solution.T_map_stop[near[i].later]);
    pairs[i].fitness.bind(references_[near[i].earlier], *features_[near[i].later], task_);
  }
  const Pose2 T_map_moved = T_map_pivot * best_shift(pairs, T_map_pivot);
  for (std::uint32_t later = first; later < stops; ++later) {
    solution.T_map_stop[later] =
        T_map_moved * geometry::between(T_map_pivot, solution.T_map_stop[later]);
  }
  solution.agreement = joint_fitness(pairs, T_map_moved);
}

const CycleSolution* KeptSolutions::best() const {
  return kept_.empty() || kept_.front().agreement < kLeastAgreement ? nullptr : &kept_.front();
}

}  // namespace topogeo::localization
