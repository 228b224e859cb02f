// Where the parts of a map lie: least squares over all that was measured within each of them and
// between them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/localization/mapping/pose_graph.hpp"
#include "topogeo/localization/mapping/stored_map.hpp"
#include "topogeo/localization/session/map_part.hpp"

namespace topogeo::localization {

/// Measured between stops of two parts.
struct PartLink {
  topomap::StopId from;
  topomap::StopId to;
  EdgeKind kind = EdgeKind::kRevisit;
  UncertainPose T_from_to;
};

/// The stops of some parts, one part after the other, of each the first so many.
struct PartStretch {
  MapPart* part = nullptr;
  std::uint32_t stops = 0;
};
using PartOrder = std::vector<PartStretch>;

/// All of each of them.
PartOrder whole_parts(std::span<MapPart* const> parts);

/// Edges and links between these stops, by their places in that order.
std::vector<PoseGraphEdge> edges_between(const PartOrder& order, std::span<const PartLink> links);

/// The stops with their poses, numbered in that order.
topomap::Trajectory trajectory_of(const PartOrder& order);
/// The same with their local maps. A stop that does not follow the one before starts a drive.
StoredMap map_of(const PartOrder& order);

/// Places all stops of the parts by everything that was measured; the first one stays where it is.
/// Leaves the poses as they are when there is no usable result.
void place_jointly(std::span<MapPart* const> parts, std::span<const PartLink> links);

}  // namespace topogeo::localization
