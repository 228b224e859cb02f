#include "topogeo/map_client/map_follower.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"

#include "convert.hpp"

namespace topogeo::service {

using detail::check;

namespace {

msg::MapElement element(msg::MapElementKind kind, std::uint32_t id, std::uint64_t version,
                        std::string_view robot_id, std::int64_t stamp_ns) {
  msg::MapElement out;
  messaging::set_header(out, robot_id, stamp_ns, 0);
  out.kind(kind);
  out.id(id);
  out.map_version(version);
  return out;
}

}  // namespace

std::vector<msg::MapElement> to_elements(const topomap::GlobalMap& map, std::uint64_t map_id,
                                         std::string_view robot_id, std::int64_t stamp_ns) {
  std::vector<msg::MapElement> out;
  out.reserve(map.nodes.size() + map.branches.size() + 1);
  for (const topomap::MapNode& node : map.nodes) {
    msg::MapElement& entry =
        out.emplace_back(element(msg::kElementNode, node.id, map.version, robot_id, stamp_ns));
    entry.observations(node.observations);
    entry.last_seen_ns(node.last_seen_ns);
    entry.node_kind(detail::to_msg(node.kind));
    entry.node_position(detail::to_branch_point(node.position_m, node.clearance_m));
  }
  for (const topomap::MapBranch& branch : map.branches) {
    msg::MapElement& entry =
        out.emplace_back(element(msg::kElementBranch, branch.id, map.version, robot_id, stamp_ns));
    entry.observations(branch.observations);
    entry.last_seen_ns(branch.last_seen_ns);
    entry.node_a(branch.node_a);
    entry.node_b(branch.node_b);
    entry.is_virtual(branch.is_virtual);
    entry.points(detail::to_branch_points(branch.points, "points"));
  }
  msg::MapElement& summary =
      out.emplace_back(element(msg::kElementSummary, 0, map.version, robot_id, stamp_ns));
  summary.map_id(map_id);
  summary.nodes(static_cast<std::uint32_t>(map.nodes.size()));
  summary.branches(static_cast<std::uint32_t>(map.branches.size()));
  return out;
}

topomap::MapNode node_from_msg(const msg::MapElement& message) {
  check(message.kind() == msg::kElementNode, "kind", "a node");
  const topomap::BranchPoint at =
      detail::from_branch_point(message.node_position(), "node_position");
  return {message.id(),           detail::from_msg(message.node_kind()),
          at.position_m,          at.clearance_m,
          message.observations(), message.last_seen_ns()};
}

topomap::MapBranch branch_from_msg(const msg::MapElement& message) {
  check(message.kind() == msg::kElementBranch, "kind", "a branch");
  return {message.id(),           message.node_a(),
          message.node_b(),       message.is_virtual(),
          message.observations(), detail::from_branch_points(message.points(), "points"),
          message.last_seen_ns()};
}

topomap::GlobalMap from_elements(const map_client::Map& map) {
  topomap::GlobalMap out;
  out.version = map.version;
  for (const auto& [id, node] : map.nodes) out.nodes.push_back(node_from_msg(*node));
  for (const auto& [id, branch] : map.branches) {
    check(map.nodes.contains(branch->node_a()), "node_a", "a node of the map");
    check(map.nodes.contains(branch->node_b()), "node_b", "a node of the map");
    out.branches.push_back(branch_from_msg(*branch));
  }
  return out;
}

}  // namespace topogeo::service
