#include "topogeo/pipeline/odometry_links.hpp"

#include <cmath>
#include <cstddef>
#include <optional>

#include <Eigen/LU>

#include "topogeo/matching/odometry_model.hpp"

namespace topogeo::pipeline {
namespace {

using localization::UncertainPose;
using Kind = storage::MapEdge::Kind;

/// The step to a stop, by all edges of odometry.
struct Step {
  std::optional<UncertainPose> odometry;  ///< none: the first stop of a drive
  int recent_matches = 0;                 ///< across this step
  int loops = 0;
};

/// Every edge adds to its first step and subtracts behind its last one; sums along the path then
/// give the number of edges across each step.
struct Changes {
  explicit Changes(std::size_t stops) : recent(stops + 1), loops(stops + 1) {}

  void add(const storage::MapEdge& edge) {
    std::vector<int>& changes = edge.kind == Kind::kLoop ? loops : recent;
    ++changes[edge.earlier_id + 1];
    --changes[edge.later_id + 1];
  }

  std::vector<int> recent;
  std::vector<int> loops;
};

/// Two measurements of one step: a graph weighs each by its covariance.
Eigen::Matrix3d combined(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return (localization::invertible(a).inverse() + localization::invertible(b).inverse()).inverse();
}

std::vector<Step> steps_of(const storage::MapDocument& document) {
  const std::size_t stops = document.local_maps.size();
  std::vector<Step> steps(stops);
  Changes changes(stops);
  for (const storage::MapEdge& edge : document.edges) {
    if (edge.earlier_id >= edge.later_id || edge.later_id >= stops) continue;
    if (edge.kind != Kind::kOdometry) {
      changes.add(edge);
      continue;
    }
    std::optional<UncertainPose>& odometry = steps[edge.later_id].odometry;
    odometry = UncertainPose{edge.T_earlier_later,
                             odometry ? combined(odometry->covariance, edge.covariance)
                                      : localization::invertible(edge.covariance)};
  }
  int recent = 0;
  int loops = 0;
  for (std::size_t stop = 0; stop < stops; ++stop) {
    steps[stop].recent_matches = recent += changes.recent[stop];
    steps[stop].loops = loops += changes.loops[stop];
  }
  return steps;
}

}  // namespace

std::vector<OdometryStretch> odometry_stretches(const storage::MapDocument& document) {
  std::vector<OdometryStretch> stretches;
  const std::vector<Step> steps = steps_of(document);
  UncertainPose along;
  for (std::uint32_t stop = 1; stop < steps.size(); ++stop) {
    const Step& step = steps[stop];
    if (!step.odometry || step.recent_matches > 0) continue;
    const bool held = step.loops > 0;
    const bool joined = !stretches.empty() && stretches.back().last_id + 1 == stop &&
                        stretches.back().held_by_loop == held;
    if (!joined) {
      along = {};
      stretches.push_back({.first_id = stop - 1, .held_by_loop = held});
    }
    along = localization::compose(along, *step.odometry);
    OdometryStretch& stretch = stretches.back();
    stretch.last_id = stop;
    stretch.length_m += std::sqrt(step.odometry->T_a_b.position_m().squaredNorm());
    stretch.off_m = 2.0 * std::sqrt(along.covariance(0, 0) + along.covariance(1, 1));
    stretch.off_rad = 2.0 * std::sqrt(along.covariance(2, 2));
  }
  return stretches;
}

}  // namespace topogeo::pipeline
