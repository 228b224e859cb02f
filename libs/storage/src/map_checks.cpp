// Checks whether the parts of a map are consistent.
#include <algorithm>
#include <stdexcept>

#include "topogeo/support/format.hpp"

#include "map_conversions.hpp"

namespace topogeo::storage {
namespace {

template <typename... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
  throw std::runtime_error(fmt::format(format, std::forward<Args>(args)...));
}

template <typename Element>
void check_ascending(const std::vector<Element>& elements, const char* what) {
  for (std::size_t i = 1; i < elements.size(); ++i) {
    if (elements[i].id <= elements[i - 1].id) {
      fail("{} {} after {}: expected ascending ids", what, elements[i].id, elements[i - 1].id);
    }
  }
}

void check_sessions(const std::vector<topomap::LocalMap>& maps) {
  for (const topomap::LocalMap& map : maps) {
    const std::uint64_t session = map.stop.session;
    if ((session == 0) == (maps.front().stop.session == 0)) continue;
    fail("local map {} is of session {:016x}: expected a session for every local map or for none",
         map.id, session);
  }
}

}  // namespace

void check_global_map(const topomap::GlobalMap& map) {
  check_ascending(map.nodes, "node");
  check_ascending(map.branches, "branch");
  const auto is_known = [&](std::uint32_t id) {
    return std::ranges::binary_search(map.nodes, id, {}, &topomap::MapNode::id);
  };
  for (const topomap::MapBranch& branch : map.branches) {
    for (const std::uint32_t node : {branch.node_a, branch.node_b}) {
      if (!is_known(node)) fail("branch {} ends at node {}, which does not exist", branch.id, node);
    }
  }
}

void check_edges(const std::vector<MapEdge>& edges, std::size_t map_count) {
  for (const MapEdge& edge : edges) {
    if (edge.earlier_id < edge.later_id && edge.later_id < map_count) continue;
    fail("edge from {} to {}: expected ascending ids below {}", edge.earlier_id, edge.later_id,
         map_count);
  }
}

void check_document(const MapDocument& document) {
  const std::size_t map_count = document.local_maps.size();
  for (std::size_t i = 0; i < map_count; ++i) {
    const topomap::LocalMap& map = document.local_maps[i];
    if (map.id != i) fail("local map {} is at index {}", map.id, i);
    if (map.robot_id.empty()) fail("local map {} has no robot", i);
  }
  const auto& stops = document.trajectory.stops;
  if (stops.size() > map_count) {
    fail("{} stops: expected at most one for each of the {} local maps", stops.size(), map_count);
  }
  for (std::size_t i = 0; i < stops.size(); ++i) {
    if (stops[i].local_map_id != i) fail("stop {} is at index {}", stops[i].local_map_id, i);
  }
  for (const topomap::LoopClosure& closure : document.loop_closures) {
    if (closure.earlier_id >= closure.later_id || closure.later_id >= map_count) {
      fail("loop closure from {} to {}: expected ascending ids below {}", closure.earlier_id,
           closure.later_id, map_count);
    }
  }
  check_edges(document.edges, map_count);
  check_verdicts(document.loop_verdicts, map_count);
  check_sessions(document.local_maps);
  check_global_map(document.global_map);
  check(document.drawing);
  check_rooms(document.rooms);
}

}  // namespace topogeo::storage
