#include "joint_poses.hpp"

#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "topogeo/slam/graph_optimization.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

std::optional<std::uint32_t> place_of(const PartOrder& order, const topomap::StopId& stop) {
  std::uint32_t first = 0;
  for (const PartStretch& stretch : order) {
    const auto found = stretch.part->find(stop);
    if (found && *found < stretch.stops) return first + *found;
    first += stretch.stops;
  }
  return std::nullopt;
}

}  // namespace

PartOrder whole_parts(std::span<MapPart* const> parts) {
  PartOrder order;
  for (MapPart* part : parts) order.push_back({part, static_cast<std::uint32_t>(part->size())});
  return order;
}

std::vector<PoseGraphEdge> edges_between(const PartOrder& order, std::span<const PartLink> links) {
  std::vector<PoseGraphEdge> out;
  std::uint32_t first = 0;
  for (const PartStretch& stretch : order) {
    for (PoseGraphEdge edge : stretch.part->edges()) {
      if (edge.to >= stretch.stops) continue;
      edge.from += first;
      edge.to += first;
      out.push_back(edge);
    }
    first += stretch.stops;
  }
  for (const PartLink& link : links) {
    const auto from = place_of(order, link.from);
    const auto to = place_of(order, link.to);
    if (!from || !to) continue;
    const bool ascends = *from < *to;
    const UncertainPose T = ascends ? link.T_from_to : inverse(link.T_from_to);
    out.push_back({ascends ? *from : *to, ascends ? *to : *from, link.kind, T.T_a_b,
                   invertible(T.covariance)});
  }
  return out;
}

topomap::Trajectory trajectory_of(const PartOrder& order) {
  topomap::Trajectory out;
  for (const PartStretch& stretch : order) {
    for (std::uint32_t i = 0; i < stretch.stops; ++i) {
      const UncertainPose& pose = stretch.part->poses()[i];
      topomap::StopPose stop = stretch.part->own().stops[i];
      stop.local_map_id = static_cast<std::uint32_t>(out.stops.size());
      stop.T_map_robot = pose.T_a_b;
      stop.covariance = pose.covariance;
      out.stops.push_back(stop);
    }
  }
  return out;
}

StoredMap map_of(const PartOrder& order) {
  StoredMap out;
  out.trajectory = trajectory_of(order);
  for (const PartStretch& stretch : order) {
    for (std::uint32_t i = 0; i < stretch.stops; ++i) {
      const auto id = static_cast<std::uint32_t>(out.maps.size());
      const topomap::LocalMap& map = *stretch.part->maps()[i];
      const bool follows = id == 0 || out.maps.back().stop.next() == map.stop;
      out.maps.push_back(topomap::numbered(map, id, !follows));
    }
  }
  return out;
}

void place_jointly(std::span<MapPart* const> parts, std::span<const PartLink> links) {
  const PartOrder order = whole_parts(parts);
  GraphProblem problem;
  for (const MapPart* part : parts) {
    for (const UncertainPose& pose : part->poses()) problem.T_map_robot.push_back(pose.T_a_b);
  }
  if (problem.T_map_robot.empty()) return;
  problem.stops.resize(problem.T_map_robot.size());
  std::iota(problem.stops.begin(), problem.stops.end(), 0U);
  problem.held.resize(problem.stops.size());
  problem.held.front() = 1;
  problem.edges = edges_between(order, links);
  problem.whole = true;
  const GraphSolution solution = solve(problem);
  if (!solution.summary.usable) return;
  PoseGraph graph;
  for (const Pose2& pose : solution.T_map_robot) graph.add_pose(pose);
  for (const PoseGraphEdge& edge : problem.edges) graph.add_edge(edge);
  graph.remove_edges(solution.outvoted);
  const std::vector<UncertainPose> relative = graph.relative_to(0);
  std::size_t next = 0;
  for (MapPart* part : parts) {
    std::vector<UncertainPose> poses;
    for (std::size_t i = 0; i < part->size(); ++i, ++next) {
      poses.push_back({solution.T_map_robot[next], relative[next].covariance});
    }
    part->place(std::move(poses));
  }
}

}  // namespace topogeo::localization
