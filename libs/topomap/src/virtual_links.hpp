// Joins parts of the global map between which the robot drove without seeing a branch (Thesis, fig.
// 8.23): a covered laser, a hall wider than the laser's range.
//
// A stop touches the map where the seen branch nearest to it became part of the map; a stop none of
// whose branches did touches it nowhere. The stops are processed in time order. If one touches
// another part of the map than the last touching stop, and the two parts are not connected yet, a
// virtual branch connects them. Its path runs from the first place straight to its stop, along the
// tracked scans and stops in between, and from the other stop straight to the other place, cut to
// the stretch between the two parts. Stops form a driven path only while the ids of their maps are
// consecutive. So local maps that overlap, even through others, are never joined this way, and
// parts that the views of later stops join lose their link.
//
// A link ends at the node near its place, or a new virtual node splits the branch there, and the
// shorter half gets a new id. Its points are at most 0.2 m apart (more on a path of over 180 m, and
// at most GlobalMapConfig::node_merge_m at its ends). Their clearance is the distance to the
// nearest scan point of the two stops around them, 0 without points. This is the distance of seen
// objects; unseen ones may be nearer, but the robot fits through, because it was there. No local
// map saw a link, so its observations are 0.
#pragma once

#include "topogeo/topomap/global_map.hpp"
#include "topogeo/topomap/global_map_builder.hpp"

#include "driven_path.hpp"

namespace topogeo::topomap {

/// First id of links, and of the nodes and half branches that they create; these ids follow from
/// the local map at the link's end alone.
constexpr std::uint32_t kFirstLinkId = 1U << 31U;

/// Adds the links that `map` needs. Nodes and branches are sorted by id, before and after.
void add_virtual_links(const DrivenPath& path, const GlobalMapConfig& config, GlobalMap& map);

}  // namespace topogeo::topomap
