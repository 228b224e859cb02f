// Local maps and the stops of a drive as JSON of the protocol.
#pragma once

#include <cstddef>
#include <optional>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/topomap/local_map.hpp"

#include "server/json_values.hpp"

namespace topogeo::web {

/// JSON of channel `local_map`: nodes and branches of the main graph and the scan points, in the
/// frame of the robot at the stop. `T_map_stop`: pose of the stop on the map, if known.
Json local_map_json(const topomap::LocalMap& map, const std::optional<geometry::Pose2>& T_map_stop);

/// Number of stops from `first` on in an answer to `GET /api/drive`: stamp, pose and outline of
/// each.
inline constexpr std::size_t kDriveStops = 200;
Json drive_json(const storage::MapDocument& map, std::size_t first);

}  // namespace topogeo::web
