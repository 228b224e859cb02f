// A finished map as it is localized in and continued.
#pragma once

#include <cstdint>
#include <vector>

#include "topogeo/localization/mapping/pose_graph.hpp"
#include "topogeo/localization/matching/odometry_model.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

/// Local maps and where they are. `maps[i]` is of `trajectory.stops[i]` and has the id i.
struct StoredMap {
  std::vector<topomap::LocalMap> maps;
  topomap::Trajectory trajectory;
  std::vector<topomap::LoopClosure> loop_closures;  ///< what continuing needs besides
  std::vector<PoseGraphEdge> edges;  ///< that the poses were made of; empty: not known
};

/// An accepted match of a stop of a drive with one of a stored map.
struct StoredMatch {
  std::uint32_t stop = 0;      ///< of the map
  UncertainPose T_stop_robot;  ///< of the drive's stop in the frame of that
  double fitness = 0.0;        ///< [0, 1]
};

/// Throws std::invalid_argument unless there are as many stops as local maps, at least one, and
/// edges lead from one of them to a later one.
void check(const StoredMap& map);

/// Of a usual match, in the frame of its first stop: for maps that do not keep those of their own.
Eigen::Matrix3d usual_match_covariance();

/// The measurements that hold the poses of a stored map together: its own; where it does not keep
/// them, one between each stop and the next, as far apart as the poses are, and its loops as they
/// were matched, with the covariances of usual matches. So later ones can bend the map as if they
/// had been there when it was made.
std::vector<PoseGraphEdge> edges_of(const StoredMap& map);

}  // namespace topogeo::localization
