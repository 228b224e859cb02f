// How a drive that was localized in a map becomes part of it: the pose of its first stop and the
// loops that connect it to the map.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "topogeo/matching/odometry_config.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/slam/pose_graph.hpp"
#include "topogeo/slam/stored_map.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

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
