// Poses of the parts of a map: least squares over all measurements within and between them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/slam/pose_graph.hpp"
#include "topogeo/slam/stored_map.hpp"

#include "map_part.hpp"

namespace topogeo::localization {

/// A measurement between stops of two parts.
struct PartLink {
  topomap::StopId from;
  topomap::StopId to;
  EdgeKind kind = EdgeKind::kRevisit;
  UncertainPose T_from_to;
};

/// The stops of some parts, one part after the other, and for each part the first `stops` of them.
struct PartStretch {
  MapPart* part = nullptr;
  std::uint32_t stops = 0;
};
using PartOrder = std::vector<PartStretch>;

/// All stops of each part.
PartOrder whole_parts(std::span<MapPart* const> parts);

/// Edges and links between these stops, numbered in that order.
std::vector<PoseGraphEdge> edges_between(const PartOrder& order, std::span<const PartLink> links);

/// The stops with their poses, in that order.
topomap::Trajectory trajectory_of(const PartOrder& order);
/// Like trajectory_of(), with the local maps. A stop that does not follow its predecessor starts a
/// drive.
StoredMap map_of(const PartOrder& order);

/// Places all stops of the parts by all measurements; the first stop does not move. Keeps the poses
/// if there is no usable result.
void place_jointly(std::span<MapPart* const> parts, std::span<const PartLink> links);

}  // namespace topogeo::localization
