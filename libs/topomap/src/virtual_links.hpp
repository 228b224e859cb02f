// Joins the parts of the global map that the robot drove between without a branch to show for it
// (Thesis, fig. 8.23): a laser that was covered, a hall wider than the laser's range.
//
// A stop touches the map at the place where the branch that it saw nearest to itself became part of
// the map; a stop whose branches all came to nothing touches it nowhere. The stops are gone through
// in time. Where one touches another part of the map than the last that touched any, and nothing
// has joined the two parts so far, a virtual branch does. It follows the path from the one place
// straight to its stop, along the tracked scans and stops between, and from the other stop straight
// to the other place; of that path it is what lies between the two parts. Stops are a driven
// path only while the ids of their maps follow each other. So local maps that overlap, even through
// others, are never joined, and parts that later stops join by what they see lose their link.
//
// A link ends at the node near its place, or a new virtual node splits the branch there, and the
// shorter half of it takes a new id. Its points are at most 0.2 m apart (more on a path of over
// 180 m, and at most GlobalMapConfig::node_merge_m at its ends); their clearance is the distance to
// the nearest scan point of the two stops about them, 0 when neither has one. That is how near
// anything seen came, not that nothing unseen is nearer: that the robot fits through is known from
// its having been there. No local map saw a link, so its observations are 0.
#pragma once

#include "topogeo/topomap/global_map.hpp"
#include "topogeo/topomap/global_map_builder.hpp"

#include "driven_path.hpp"

namespace topogeo::topomap {

/// Ids of links, and of the nodes and half branches that they make, start here; they follow from
/// the local map at the link's end alone.
constexpr std::uint32_t kFirstLinkId = 1U << 31U;

/// Adds the links that `map` needs. Nodes and branches are sorted by id, before and after.
void add_virtual_links(const DrivenPath& path, const GlobalMapConfig& config, GlobalMap& map);

}  // namespace topogeo::topomap
