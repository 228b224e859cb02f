// A finished map that robots localize in and continue, and how a drive that was localized in it
// becomes part of it: the pose of its first stop and the loops that connect it to the map.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "topogeo/matching/match_config.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/slam/pose_graph.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

/// Local maps and their poses. `maps[i]` belongs to `trajectory.stops[i]` and has the id i.
struct StoredMap {
  std::vector<topomap::LocalMap> maps;
  topomap::Trajectory trajectory;
  std::vector<topomap::LoopClosure> loop_closures;  ///< also needed to continue the map
  std::vector<PoseGraphEdge> edges;                 ///< edges behind the poses; empty: not known
};

/// An accepted match of a stop of a drive with one of a stored map.
struct StoredMatch {
  std::uint32_t stop = 0;      ///< of the map
  UncertainPose T_stop_robot;  ///< pose of the drive's stop in the frame of that stop
  double fitness = 0.0;        ///< [0, 1]
};

/// Throws std::invalid_argument unless there are as many stops as local maps, at least one, and
/// every edge leads from a stop to a later one.
void check(const StoredMap& map);

/// Covariance of a typical match, in the frame of its first stop: for maps stored without edges.
Eigen::Matrix3d usual_match_covariance();

/// The measurements that hold the poses of a stored map together: its own edges. Without them: one
/// edge between each stop and the next, by their poses, and its loops as matched, with the
/// covariance of typical matches. Later matches can then bend the map as if they had been there
/// when it was made.
std::vector<PoseGraphEdge> edges_of(const StoredMap& map);

/// The first stop of a drive relative to the last one of the map: through the best match of the
/// drive's last stop, then backwards along the drive's odometry. `map` holds the poses of the map.
/// Throws std::invalid_argument without stops or matches, or for a match with a stop outside the
/// map.
UncertainPose first_stop_of_drive(const PoseGraph& map,
                                  std::span<const std::shared_ptr<const topomap::LocalMap>> drive,
                                  std::span<const StoredMatch> matches_of_last,
                                  const OdometryNoise& noise);

/// The match as a loop of the drive's last stop, whose id in the map is `last_id`.
PoseGraphEdge loop_of(const StoredMatch& match, std::uint32_t last_id);

/// Whether one of the edges is of the same kind between the same stops.
bool contains_like(std::span<const PoseGraphEdge> edges, const PoseGraphEdge& edge);

}  // namespace topogeo::localization
