#include "matching_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/Eigenvalues>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::bench {
namespace {

using geometry::Pose2;
using support::Random;

constexpr double kOverlap = 0.35;
constexpr double kApart = 0.05;
constexpr double kWallTolerance_m = 0.10;  // the far side of a wall is not in view
constexpr double kBareCorridor = 0.10;     // largest share of wall points that face along it

bool overlaps(const MatchingRun& run, std::size_t a, std::size_t b, const Pose2& T_a_b) {
  constexpr double kFarthest_m = 15.0;
  constexpr double kTolerance_m = 0.3;
  return T_a_b.position_m().norm() < kFarthest_m &&
         run.in_view(a, b, T_a_b, kTolerance_m) >= kOverlap &&
         run.in_view(b, a, geometry::inverse(T_a_b), kTolerance_m) >= kOverlap;
}

bool lie_apart(const MatchingRun& run, std::size_t a, std::size_t b, const Pose2& T_a_b) {
  return run.in_view(a, b, T_a_b, kWallTolerance_m) < kApart &&
         run.in_view(b, a, geometry::inverse(T_a_b), kWallTolerance_m) < kApart;
}

/// All overlapping pairs, later stop first; either those a few stops apart or the others.
std::vector<StopPair> all_overlapping(const MatchingRun& run, bool recent) {
  constexpr std::size_t kRecent = 6;
  std::vector<StopPair> pairs;
  for (std::size_t later = 1; later < run.size(); ++later) {
    for (std::size_t earlier = 0; earlier < later; ++earlier) {
      if ((later - earlier <= kRecent) != recent) continue;
      const auto T = run.truth(later, earlier);
      if (T && overlaps(run, later, earlier, *T)) pairs.push_back({later, earlier, *T, *T});
    }
  }
  return pairs;
}

/// Moves a random choice to the front and drops the rest.
void choose(std::vector<StopPair>& pairs, std::size_t count, Random& random) {
  for (std::size_t i = 0; i < std::min(count, pairs.size()); ++i) {
    std::swap(pairs[i], pairs[i + random.below(pairs.size() - i)]);
  }
  pairs.resize(std::min(count, pairs.size()));
}

/// Direction of the walls that a stop sees, if it sees hardly any others; in the stop's frame.
std::optional<Eigen::Vector2d> corridor_of(const localization::MatchFeatures& features) {
  constexpr std::size_t kFewest = 40;
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  std::size_t count = 0;
  for (const localization::SurfacePoint& point : features.surface) {
    if (!point.on_line) continue;
    scatter += point.normal * point.normal.transpose();
    ++count;
  }
  if (count < kFewest) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(scatter);
  if (solver.eigenvalues()[0] > kBareCorridor * static_cast<double>(count)) return std::nullopt;
  return solver.eigenvectors().col(0);
}

/// Histogram of the distances between two points of a stop: the same from any pose.
using Shape = std::array<double, 40>;

Shape shape_of(const std::vector<localization::SurfacePoint>& points) {
  constexpr double kBin_m = 0.5;
  Shape shape{};
  double sum = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const auto bin =
          static_cast<std::size_t>((points[i].position_m - points[j].position_m).norm() / kBin_m);
      if (bin >= shape.size()) continue;
      shape[bin] += 1.0;
      sum += 1.0;
    }
  }
  if (sum > 0.0) {
    for (double& bin : shape) bin /= sum;
  }
  return shape;
}

double unlike(const Shape& a, const Shape& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::fabs(a[i] - b[i]);
  return sum;
}

/// The stops that do not overlap with `stop`, the most similar in shape first.
std::vector<StopPair> candidates(const MatchingRun& run, const std::vector<Shape>& shapes,
                                 std::size_t stop, std::size_t count) {
  std::vector<std::pair<double, std::size_t>> others;
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (i != stop && run.truth(stop, i)) others.emplace_back(unlike(shapes[stop], shapes[i]), i);
  }
  std::sort(others.begin(), others.end());
  std::vector<StopPair> found;
  for (const auto& [difference, other] : others) {
    if (found.size() == count) break;
    const Pose2 T = *run.truth(stop, other);
    if (lie_apart(run, stop, other, T)) found.push_back({stop, other, T, {}});
  }
  return found;
}

/// Pose at which the query looks most like the reference, regardless of odometry, and its fitness.
std::pair<Pose2, double> best_fit(MatchingRun& run, const StopPair& pair) {
  constexpr double kAnywhere = 100.0;
  localization::UncertainPose anywhere;
  anywhere.covariance = Eigen::Matrix3d::Identity() * kAnywhere;
  localization::MatchTask task = run.task(pair.reference, pair.query, anywhere);
  task.half_width = {4.0, 4.0, std::numbers::pi};
  task.genetic.individuals = 80;
  task.genetic.generations = 40;
  task.fitness_form = localization::FitnessForm::kCombined;
  const localization::MatchResult result = run.matcher().solve(task);
  return {result.T_reference_query, result.fitness};
}

}  // namespace

std::vector<StopPair> overlapping_pairs(const MatchingRun& run, std::size_t count, Random& random) {
  std::vector<StopPair> pairs = all_overlapping(run, true);
  choose(pairs, (count + 1) / 2, random);
  std::vector<StopPair> revisits = all_overlapping(run, false);
  choose(revisits, count - pairs.size(), random);
  pairs.insert(pairs.end(), revisits.begin(), revisits.end());
  return pairs;
}

std::vector<StopPair> corridor_pairs(const MatchingRun& run, std::size_t count, Random& random) {
  std::vector<StopPair> pairs = all_overlapping(run, true);
  const std::vector<StopPair> revisits = all_overlapping(run, false);
  pairs.insert(pairs.end(), revisits.begin(), revisits.end());
  std::erase_if(pairs, [&](StopPair& pair) {
    const auto along = corridor_of(run.features(pair.query));
    if (!along) return true;
    const geometry::SinCos r = geometry::sincos(pair.T_reference_query.theta_rad);
    pair.along = {r.cos * along->x() - r.sin * along->y(), r.sin * along->x() + r.cos * along->y()};
    return false;
  });
  choose(pairs, count, random);
  return pairs;
}

std::vector<StopPair> apart_pairs(const MatchingRun& run, std::size_t count, Random& random) {
  constexpr double kReach_m = 6.0;
  constexpr double kTolerance_m = 0.5;
  constexpr int kTries = 200;
  std::vector<StopPair> pairs;
  // A log may have few such pairs, so the draws are limited.
  for (std::size_t draw = 0; draw < 20 * count && pairs.size() < count; ++draw) {
    StopPair pair{random.below(run.size()), random.below(run.size()), {}, {}};
    const auto T = run.truth(pair.reference, pair.query);
    if (pair.reference == pair.query || !T || !lie_apart(run, pair.reference, pair.query, *T)) {
      continue;
    }
    pair.T_reference_query = *T;
    for (int i = 0; i < kTries; ++i) {
      pair.T_reference_looked = {random.uniform(-kReach_m, kReach_m),
                                 random.uniform(-kReach_m, kReach_m),
                                 random.uniform(-std::numbers::pi, std::numbers::pi)};
      if (run.in_view(pair.reference, pair.query, pair.T_reference_looked, kTolerance_m) <
          kOverlap) {
        continue;
      }
      pairs.push_back(pair);
      break;
    }
  }
  return pairs;
}

std::vector<StopPair> look_alike_pairs(MatchingRun& run, std::size_t count) {
  constexpr std::size_t kCandidates = 4;
  std::vector<Shape> shapes;
  for (std::size_t i = 0; i < run.size(); ++i) shapes.push_back(shape_of(run.features(i).coarse));
  const std::size_t stops = std::min(count, run.size());
  std::vector<StopPair> pairs;
  for (std::size_t k = 0; k < stops; ++k) {
    double best = 0.0;
    std::optional<StopPair> most_alike;
    for (StopPair& pair : candidates(run, shapes, k * run.size() / stops, kCandidates)) {
      const auto [T, fitness] = best_fit(run, pair);
      if (fitness <= best) continue;
      best = fitness;
      pair.T_reference_looked = T;
      most_alike = pair;
    }
    if (most_alike) pairs.push_back(*most_alike);
  }
  return pairs;
}

}  // namespace topogeo::bench
