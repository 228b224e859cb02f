// How a drive that has found itself in a map becomes part of it: where its first stop lies, and by
// which loops it hangs together with the map.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "topogeo/localization/mapping/pose_graph.hpp"
#include "topogeo/localization/mapping/stored_map.hpp"
#include "topogeo/localization/matching/odometry_config.hpp"
#include "topogeo/localization/matching/odometry_model.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

/// The first stop of a drive seen from the last one of the map: through the best match of the
/// drive's last stop, backwards along the drive's odometry. `map` holds the poses of the map.
/// Throws std::invalid_argument without stops or matches, or for a match with a stop that is not in
/// the map.
UncertainPose first_stop_of_drive(const PoseGraph& map,
                                  std::span<const std::shared_ptr<const topomap::LocalMap>> drive,
                                  std::span<const StoredMatch> matches_of_last,
                                  const OdometryNoise& noise);

/// The match as a loop of the drive's last stop, which has this id in the map.
PoseGraphEdge loop_of(const StoredMatch& match, std::uint32_t last_id);

/// Whether one of the edges is of the same kind between the same stops.
bool contains_like(std::span<const PoseGraphEdge> edges, const PoseGraphEdge& edge);

}  // namespace topogeo::localization
