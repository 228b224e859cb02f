#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/LU>

#include "topogeo/calibration/odometry_calibration.hpp"
#include "topogeo/matching/fitness_forms.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/match_gate.hpp"
#include "topogeo/matching/refinement.hpp"
#include "topogeo/topomap/pose_at.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using topomap::StampedPose;

// Fixed: these follow from refinement and gate, not from a robot.
constexpr double kWeakPrior = 0.25;      // information, 1/m^2 and 1/rad^2, as in match_covariance
constexpr double kLargestMove_m = 0.3;   // by refinement without prior; beyond it: another place
constexpr double kContradiction = 25.0;  // squared Mahalanobis distance from the trajectory
constexpr std::int64_t kLongestGap_ns = 500'000'000;  // between reference poses to interpolate

}  // namespace

void RecordingPool::add_map(std::shared_ptr<const topomap::LocalMap> map) {
  pool_.add_map(std::move(map));
}

std::vector<MatchResult> RecordingPool::match(std::span<const MatchTask> tasks) {
  std::vector<MatchResult> results = pool_.match(tasks);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (results[i].verdict != Verdict::kAccepted) continue;
    accepted_.push_back({tasks[i].reference_map_id, tasks[i].query_map_id, results[i]});
  }
  return results;
}

std::vector<OdometryStretch> odometry_stretches(const LocalMaps& maps) {
  std::vector<OdometryStretch> stretches;
  for (std::size_t i = 1; i < maps.size(); ++i) {
    OdometryStretch stretch;
    Pose2 T_odom_before = maps[i - 1]->T_odom_robot;
    for (const topomap::TrackedScan& scan : maps[i]->track) {
      stretch.push_back(geometry::between(T_odom_before, scan.T_odom_robot));
      T_odom_before = scan.T_odom_robot;
    }
    stretch.push_back(geometry::between(T_odom_before, maps[i]->T_odom_robot));
    stretches.push_back(std::move(stretch));
  }
  return stretches;
}

MatchedMotions motions_from_matches(const LocalMaps& maps,
                                    std::span<const RecordingPool::Match> matches,
                                    const topomap::Trajectory& trajectory) {
  MatchedMotions found;
  PosePrior prior;
  prior.information.diagonal().setConstant(kWeakPrior);
  std::optional<std::uint32_t> reference_id;
  Reference reference;
  for (const RecordingPool::Match& match : matches) {
    if (reference_id != match.reference_map_id) {
      reference = make_reference(extract_features(*maps.at(match.reference_map_id)));
      reference_id = match.reference_map_id;
    }
    const Pose2& T_matched = match.result.T_reference_query;
    prior.T_reference_query = T_matched;
    const Refinement refined =
        refine(reference, extract_features(*maps.at(match.query_map_id)), T_matched, prior);
    const Eigen::Vector3d moved = geometry::difference(refined.T_reference_query, T_matched);
    if (refined.information.isZero(0.0) || moved.head<2>().norm() > kLargestMove_m) {
      ++found.unrefined;
      continue;
    }
    MeasuredMotion motion{match.reference_map_id, match.query_map_id, refined.T_reference_query,
                          match_covariance(refined.information, doubt(match.result))};
    if (motion.first > motion.last) {
      motion.covariance = geometry::inverse_covariance(motion.T_first_last, motion.covariance);
      motion.T_first_last = geometry::inverse(motion.T_first_last);
      std::swap(motion.first, motion.last);
    }
    const Pose2 T_together = geometry::between(trajectory.stops.at(motion.first).T_map_robot,
                                               trajectory.stops.at(motion.last).T_map_robot);
    const Eigen::Vector3d error = geometry::difference(motion.T_first_last, T_together);
    if (error.dot(motion.covariance.inverse() * error) > kContradiction) {
      ++found.contradicted;
      continue;
    }
    found.motions.push_back(motion);
  }
  return found;
}

std::vector<MeasuredMotion> motions_from_reference(const LocalMaps& maps,
                                                   std::span<const StampedPose> reference,
                                                   double longest_path_m) {
  const Eigen::Matrix3d covariance = match_covariance(1e9 * Eigen::Matrix3d::Identity(), 0.0);
  const std::vector<OdometryStretch> stretches = odometry_stretches(maps);
  std::vector<std::optional<Pose2>> poses;
  poses.reserve(maps.size());
  for (const auto& map : maps)
    poses.push_back(topomap::pose_at(reference, map->stamp_ns, kLongestGap_ns));
  std::vector<MeasuredMotion> motions;
  for (std::uint32_t first = 0; first + 1 < maps.size(); ++first) {
    if (!poses[first]) continue;
    double path_m = 0.0;
    std::uint32_t wanted = first + 1;
    for (std::uint32_t last = first + 1; last < maps.size(); ++last) {
      for (const Pose2& step : stretches[last - 1]) {
        path_m += std::sqrt(step.position_m().squaredNorm());
      }
      if (last > first + 1 && path_m > longest_path_m) break;
      if (last < wanted) continue;
      // Long motions from the same start show nearly the same: 1, 2, 3, 4, 6, 9, 13 ... stops.
      wanted = last + std::max(1U, (last - first) / 2);
      if (poses[last]) {
        motions.push_back(
            {first, last, geometry::between(*poses[first], *poses[last]), covariance});
      }
    }
  }
  return motions;
}

}  // namespace topogeo::localization
