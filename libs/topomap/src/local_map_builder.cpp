#include "topogeo/topomap/local_map_builder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "topogeo/geometry/portable_math.hpp"

#include "local_map_states.hpp"

namespace topogeo::topomap {
namespace {

using voronoi::DiagramBranch;
using voronoi::LocalVoronoiDiagram;

std::uint32_t add_node(LocalMap& map, NodeKind kind, const BranchPoint& at,
                       const std::array<std::uint16_t, 2>& groups) {
  LocalNode node;
  node.id = static_cast<std::uint32_t>(map.nodes.size());
  node.kind = kind;
  node.position_m = at.position_m;
  node.clearance_m = at.clearance_m;
  node.base_groups.assign(groups.begin(), groups.end());
  map.nodes.push_back(std::move(node));
  return map.nodes.back().id;
}

void add_diagram_nodes(const LocalVoronoiDiagram& diagram, const geometry::Pose2& T_robot_laser,
                       LocalMap& map) {
  for (const voronoi::DiagramNode& from : diagram.nodes) {
    LocalNode node;
    node.id = static_cast<std::uint32_t>(map.nodes.size());
    node.kind = diagram.is_virtual ? NodeKind::kVirtual : NodeKind::kReal;
    node.position_m = T_robot_laser * from.position_m;
    node.clearance_m = from.clearance_m;
    node.base_groups = from.base_groups;
    map.nodes.push_back(std::move(node));
  }
}

std::size_t nearest_to_robot(const std::vector<BranchPoint>& points) {
  const auto nearer = [](const BranchPoint& a, const BranchPoint& b) {
    return a.position_m.squaredNorm() < b.position_m.squaredNorm();
  };
  return static_cast<std::size_t>(std::min_element(points.begin(), points.end(), nearer) -
                                  points.begin());
}

/// 5.5: walks outward from the real node, or from the point nearest to the robot, and ends a loose
/// end before the first step longer than the threshold. Successive points are compared, not each
/// with the start (spec A2, errata).
void cut_far_points(const DiagramBranch& branch, double separated_m,
                    std::vector<BranchPoint>& points) {
  const bool loose_a = branch.node_a == DiagramBranch::kLoose;
  const bool loose_b = branch.node_b == DiagramBranch::kLoose;
  if (!loose_a && !loose_b) return;
  const auto apart = [&](std::size_t i) {
    return (points[i + 1].position_m - points[i].position_m).norm() > separated_m;
  };
  const std::size_t start =
      loose_a && loose_b ? nearest_to_robot(points) : (loose_a ? points.size() - 1 : 0);
  std::size_t first = start;
  std::size_t last = start;
  while (first > 0 && !(loose_a && apart(first - 1))) --first;
  while (last + 1 < points.size() && !(loose_b && apart(last))) ++last;
  points.erase(points.begin() + static_cast<std::ptrdiff_t>(last) + 1, points.end());
  points.erase(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(first));
}

/// Adds a branch, in two or more pieces where it has states.
void add_branch(const DiagramBranch& from, std::vector<BranchPoint> points, bool is_virtual,
                const LocalMapConfig& config, LocalMap& map) {
  const NodeKind end_kind = is_virtual ? NodeKind::kVirtual : NodeKind::kFictitious;
  const auto end_node = [&](std::uint32_t node, const BranchPoint& at) {
    return node == DiagramBranch::kLoose ? add_node(map, end_kind, at, from.base_groups) : node;
  };
  const std::uint32_t node_a = end_node(from.node_a, points.front());
  const std::uint32_t node_b = end_node(from.node_b, points.back());
  const auto add_piece = [&](std::uint32_t a, std::uint32_t b, std::size_t first,
                             std::size_t last) {
    LocalBranch branch;
    branch.id = static_cast<std::uint32_t>(map.branches.size());
    branch.node_a = a;
    branch.node_b = b;
    branch.base_groups = from.base_groups;
    branch.is_virtual = is_virtual;
    branch.points.assign(points.begin() + static_cast<std::ptrdiff_t>(first),
                         points.begin() + static_cast<std::ptrdiff_t>(last) + 1);
    map.branches.push_back(std::move(branch));
  };
  std::uint32_t before = node_a;
  std::size_t first = 0;
  if (config.find_states && !is_virtual) {
    for (const BranchState& state : find_branch_states(points, config)) {
      const std::uint32_t node = add_node(map, state.kind, points[state.point], from.base_groups);
      add_piece(before, node, first, state.point);
      before = node;
      first = state.point;
    }
  }
  add_piece(before, node_b, first, points.size() - 1);
}

/// Groups of connected nodes.
class Components {
 public:
  explicit Components(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[root(a)] = root(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Marks the graph nearest to the robot (def. 5.2.2). Loose ends of the same base groups that lie
/// nearer than the threshold of 5.5 are ends of one branch that the laser did not see whole.
void mark_main_graph(double separated_m, LocalMap& map) {
  Components components(map.nodes.size());
  double best_sq = std::numeric_limits<double>::infinity();
  std::uint32_t nearest = 0;
  for (const LocalBranch& branch : map.branches) {
    components.join(branch.node_a, branch.node_b);
    const double sq = branch.points[nearest_to_robot(branch.points)].position_m.squaredNorm();
    if (sq < best_sq) {
      best_sq = sq;
      nearest = branch.node_a;
    }
  }
  for (const LocalNode& a : map.nodes) {
    if (a.kind != NodeKind::kFictitious) continue;
    for (std::size_t i = a.id + 1; i < map.nodes.size(); ++i) {
      const LocalNode& b = map.nodes[i];
      if (b.kind == NodeKind::kFictitious && a.base_groups == b.base_groups &&
          (a.position_m - b.position_m).norm() <= separated_m) {
        components.join(a.id, b.id);
      }
    }
  }
  for (LocalNode& node : map.nodes) {
    node.in_main_graph = components.root(node.id) == components.root(nearest);
  }
  for (LocalBranch& branch : map.branches) {
    branch.in_main_graph = map.nodes[branch.node_a].in_main_graph;
  }
}

}  // namespace

std::vector<ScanPoint> scan_points(const scan::Scan& scan, const geometry::Pose2& T_robot_laser,
                                   double range_limit_m) {
  std::vector<ScanPoint> points;
  points.reserve(scan.ranges_m.size());
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const auto range_m = static_cast<double>(scan.ranges_m[i]);
    if (!(range_m > 0.0 && range_m <= range_limit_m)) continue;
    const auto [sin, cos] =
        geometry::sincos(scan.angle_min_rad + static_cast<double>(i) * scan.angle_step_rad);
    const Eigen::Vector2d point_m = T_robot_laser * Eigen::Vector2d{range_m * cos, range_m * sin};
    points.push_back({static_cast<float>(point_m.x()), static_cast<float>(point_m.y())});
  }
  return points;
}

void build_local_map(const LocalVoronoiDiagram& diagram, const scan::Scan& scan,
                     const geometry::Pose2& T_robot_laser, const LocalMapConfig& config,
                     LocalMap& out) {
  out.T_robot_laser = T_robot_laser;
  out.nodes.clear();
  out.branches.clear();
  add_diagram_nodes(diagram, T_robot_laser, out);
  std::vector<BranchPoint> points;
  for (const DiagramBranch& branch : diagram.branches) {
    points.clear();
    for (const voronoi::DiagramPoint& point : diagram.points_of(branch)) {
      points.push_back({T_robot_laser * point.position_m, point.clearance_m});
    }
    cut_far_points(branch, config.separated_m, points);
    if (points.size() >= 2) add_branch(branch, points, diagram.is_virtual, config, out);
  }
  mark_main_graph(config.separated_m, out);
  out.points = scan_points(scan, T_robot_laser, config.range_limit_m);
}

}  // namespace topogeo::topomap
