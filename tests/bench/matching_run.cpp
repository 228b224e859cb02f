#include "matching_run.hpp"

#include <cmath>
#include <utility>

#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/slam/match_requests.hpp"
#include "topogeo/support/seed.hpp"

namespace topogeo::bench {

using geometry::Pose2;
using localization::MatchTask;
using localization::UncertainPose;

MatchingRun::MatchingRun(const Recording& recording, const pipeline::Config& config)
    : name_(recording.name), config_(config.localizer) {
  pipeline::LocalMapper mapper(config.local_mapper, "robot");
  const auto take = [&](std::optional<topomap::LocalMap> map, std::size_t scan) {
    if (!map) return;
    maps_.push_back(std::make_shared<const topomap::LocalMap>(std::move(*map)));
    hashes_.push_back(topomap::content_hash(*maps_.back()));
    features_.push_back(localization::extract_features(*maps_.back()));
    T_world_robot_.push_back(recording.T_world_robot[scan]);
    matcher_.add_map(*maps_.back());
  };
  for (std::size_t i = 0; i < recording.scans.size(); ++i) take(mapper.add(recording.scans[i]), i);
  if (!recording.scans.empty()) take(mapper.finish(), recording.scans.size() - 1);
}

std::optional<Pose2> MatchingRun::truth(std::size_t a, std::size_t b) const {
  if (!T_world_robot_[a] || !T_world_robot_[b]) return std::nullopt;
  return geometry::between(*T_world_robot_[a], *T_world_robot_[b]);
}

UncertainPose MatchingRun::odometry(std::size_t earlier, std::size_t later) const {
  UncertainPose sum;
  for (std::size_t i = earlier; i < later; ++i) {
    const UncertainPose step = localization::odometry_between_stops(
        maps_[i]->T_odom_robot, *maps_[i + 1], config_.odometry);
    sum = {sum.T_a_b * step.T_a_b,
           geometry::compose_covariance(sum.T_a_b, sum.covariance, step.T_a_b, step.covariance)};
  }
  // The localizer adds the same, so that the covariance of a robot that only turned is invertible.
  sum.covariance(0, 0) += 1e-4;
  sum.covariance(1, 1) += 1e-4;
  sum.covariance(2, 2) += 1e-5;
  return sum;
}

Pose2 MatchingRun::tracked(std::size_t earlier, std::size_t later) const {
  Pose2 T_earlier_later;
  for (std::size_t i = earlier; i < later; ++i) {
    T_earlier_later = T_earlier_later * maps_[i + 1]->T_previous_robot;
  }
  return T_earlier_later;
}

double MatchingRun::in_view(std::size_t viewer, std::size_t seen, const Pose2& T_viewer_seen,
                            double tolerance_m) const {
  using View = localization::RangeProfile::View;
  const auto& points = features_[seen].coarse;
  if (points.empty()) return 0.0;
  std::size_t count = 0;
  for (const localization::SurfacePoint& point : points) {
    const View view = features_[viewer].profile.view(T_viewer_seen * point.position_m, tolerance_m);
    if (view == View::kFree || view == View::kSurface) ++count;
  }
  return static_cast<double>(count) / static_cast<double>(points.size());
}

MatchTask MatchingRun::task(std::size_t reference, std::size_t query,
                            const UncertainPose& T_reference_query) const {
  MatchTask task = localization::match_task(config_, T_reference_query);
  task.reference_map_id = maps_[reference]->id;
  task.query_map_id = maps_[query]->id;
  task.reference_hash = hashes_[reference];
  task.query_hash = hashes_[query];
  task.seed = support::derive_seed(config_.seed, name_, {reference, query});
  return task;
}

PoseError error_of(const Pose2& estimate, const Pose2& truth) {
  return {(estimate.position_m() - truth.position_m()).norm(),
          std::fabs(geometry::wrap_angle(estimate.theta_rad - truth.theta_rad))};
}

}  // namespace topogeo::bench
