// matcher_fingerprint: hash that tells whether two programs give the same answers.
#include <bit>
#include <cstdint>

#include "topogeo/matching/fitness_forms.hpp"
#include "topogeo/matching/matcher.hpp"
#include "topogeo/support/seed.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

// The contour of a room with a recess, starting at the corner in the direction -pi, as a laser
// inside sees it. In the frame given by `T_robot_room`.
constexpr double kCorners_m[][2] = {{-2.0, -2.0}, {2.0, -2.0}, {2.0, 0.5},  {3.5, 0.5},
                                    {3.5, 2.5},   {-2.0, 2.5}, {-2.0, -2.0}};

topomap::LocalMap room_map(std::uint32_t id, const Pose2& T_robot_room) {
  topomap::LocalMap map;
  map.robot_id = "fingerprint";
  map.id = id;
  for (std::size_t side = 0; side + 1 < std::size(kCorners_m); ++side) {
    const Eigen::Vector2d from(kCorners_m[side][0], kCorners_m[side][1]);
    const Eigen::Vector2d to(kCorners_m[side + 1][0], kCorners_m[side + 1][1]);
    constexpr int kPoints = 24;
    for (int i = 0; i < kPoints; ++i) {
      const Eigen::Vector2d p = T_robot_room * Eigen::Vector2d(from + (to - from) * i / kPoints);
      map.points.push_back({static_cast<float>(p.x()), static_cast<float>(p.y())});
    }
  }
  const Eigen::Vector2d ends_m[] = {{0.0, 0.2}, {-1.5, 2.0}, {-1.5, -1.5}, {3.0, 1.5}};
  for (std::uint32_t k = 0; k < std::size(ends_m); ++k) {
    topomap::LocalNode node;
    node.id = k;
    node.position_m = T_robot_room * ends_m[k];
    node.clearance_m = k == 0 ? 1.7 : 0.5;
    map.nodes.push_back(node);
    if (k == 0) continue;
    topomap::LocalBranch branch;
    branch.id = k - 1;
    branch.node_b = k;
    for (int i = 0; i <= 20; ++i) {
      branch.points.push_back(
          {T_robot_room * Eigen::Vector2d(ends_m[0] + (ends_m[k] - ends_m[0]) * i / 20.0),
           1.7 - 0.06 * i});
    }
    map.branches.push_back(branch);
  }
  return map;
}

class Hash {
 public:
  void add(std::uint64_t value) { value_ = support::splitmix64(value_ ^ value); }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(const Pose2& T) {
    for (const double value : {T.x_m, T.y_m, T.theta_rad}) add(value);
  }
  void add(const MatchSolution& solution) {
    add(solution.T_reference_query);
    add(solution.fitness);
  }
  void add(const MatchResult& result) {
    for (const MatchSolution& solution : result.solutions) add(solution);
    add(result.second);
    add(result.T_reference_query);
    for (int i = 0; i < 9; ++i) add(result.covariance(i));
    for (const double value :
         {result.overlap, result.inliers, result.violations, result.residual_rms_m,
          result.scan_fitness, result.topological_fitness, result.fitness}) {
      add(value);
    }
    for (const std::uint64_t value :
         {std::uint64_t{result.evaluations}, static_cast<std::uint64_t>(result.status),
          static_cast<std::uint64_t>(result.verdict), static_cast<std::uint64_t>(result.reason)}) {
      add(value);
    }
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 1;
};

}  // namespace

std::uint64_t matcher_fingerprint() {
  const topomap::LocalMap reference = room_map(0, {});
  const topomap::LocalMap query = room_map(1, geometry::inverse(Pose2{0.35, -0.15, 0.2}));
  Matcher matcher;
  matcher.add_map(reference);
  matcher.add_map(query);
  MatchTask task;
  task.query_map_id = 1;
  task.reference_hash = topomap::content_hash(reference);
  task.query_hash = topomap::content_hash(query);
  task.T_reference_query = {0.3, 0.0, 0.1};
  task.covariance.diagonal() << 0.02, 0.02, 0.01;
  task.half_width = {0.4, 0.4, 0.3};
  task.genetic.individuals = 16;
  task.genetic.generations = 8;
  task.seed = 5;
  Hash hash;
  for (const FitnessForm form : fitness_forms()) {
    task.fitness_form = form;
    const MatchResult result = matcher.solve(task);
    hash.add(result);
  }
  task.evidence = MatchEvidence::kBranches;
  task.genetic.finer_resolution_m = 0.03;
  const MatchResult by_branches = matcher.solve(task);
  hash.add(by_branches);
  return hash.value();
}

}  // namespace topogeo::localization
