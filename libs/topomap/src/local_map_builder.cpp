#include "topogeo/topomap/local_map_builder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>

#include "topogeo/geometry/portable_math.hpp"

#include "components.hpp"
#include "local_map_states.hpp"
#include "recycled.hpp"

namespace topogeo::topomap {
namespace {

using voronoi::DiagramBranch;
using voronoi::LocalVoronoiDiagram;

std::size_t nearest_to_robot(const std::vector<BranchPoint>& points) {
  const auto nearer = [](const BranchPoint& a, const BranchPoint& b) {
    return a.position_m.squaredNorm() < b.position_m.squaredNorm();
  };
  return static_cast<std::size_t>(std::min_element(points.begin(), points.end(), nearer) -
                                  points.begin());
}

}  // namespace

class LocalMapBuilder::Work {
 public:
  explicit Work(const LocalMapConfig& config) : config_(config) {}

  void build(const LocalVoronoiDiagram& diagram, const scan::Scan& scan,
             const geometry::Pose2& T_robot_laser, LocalMap& out);

 private:
  [[nodiscard]] bool confirms(double clearance_m, double hidden_m) const {
    return hidden_m <= config_.largest_hidden_share * clearance_m;
  }
  void add_diagram_nodes(const LocalVoronoiDiagram& diagram, const geometry::Pose2& T_robot_laser);
  std::uint32_t add_node(NodeKind kind, const BranchPoint& at,
                         std::span<const std::uint16_t> groups);
  void take_points(const LocalVoronoiDiagram& diagram, const DiagramBranch& branch,
                   const geometry::Pose2& T_robot_laser);
  void cut_far_points(const DiagramBranch& branch);
  [[nodiscard]] std::size_t end_of_stretch(std::size_t first) const;
  void absorb_short_stretches(bool short_ones_are);
  void find_cuts();
  void add_branch(const DiagramBranch& from, bool is_virtual);
  void add_piece(const DiagramBranch& from, bool is_virtual, std::uint32_t node_a,
                 std::uint32_t node_b, std::size_t first, std::size_t last);
  void mark_main_graph(LocalMap& map);
  [[nodiscard]] std::uint32_t find_main_graph(const LocalMap& map);
  void remove_off_main_graph(LocalMap& map);

  LocalMapConfig config_;
  Recycled<LocalNode> nodes_;
  Recycled<LocalBranch> branches_;
  Components components_;
  BranchStateFinder state_finder_;
  // For the current branch.
  std::vector<BranchPoint> points_;
  std::vector<char> confirmed_;      // per point
  std::vector<BranchState> cuts_;    // where the branch is divided, in order
  std::vector<double> length_m_;     // per root: total of all its branches
  std::vector<std::uint32_t> kept_;  // new id of each node
};

void LocalMapBuilder::Work::add_diagram_nodes(const LocalVoronoiDiagram& diagram,
                                              const geometry::Pose2& T_robot_laser) {
  for (const voronoi::DiagramNode& from : diagram.nodes) {
    NodeKind kind = NodeKind::kFictitious;
    if (diagram.is_virtual) {
      kind = NodeKind::kVirtual;
    } else if (confirms(from.clearance_m, from.hidden_m)) {
      kind = NodeKind::kReal;
    }
    add_node(kind, {T_robot_laser * from.position_m, from.clearance_m}, diagram.groups_of(from));
  }
}

std::uint32_t LocalMapBuilder::Work::add_node(NodeKind kind, const BranchPoint& at,
                                              std::span<const std::uint16_t> groups) {
  const auto id = static_cast<std::uint32_t>(nodes_.size());
  LocalNode& node = nodes_.add();
  node.id = id;
  node.kind = kind;
  node.position_m = at.position_m;
  node.clearance_m = at.clearance_m;
  node.base_groups.assign(groups.begin(), groups.end());
  return id;
}

void LocalMapBuilder::Work::take_points(const LocalVoronoiDiagram& diagram,
                                        const DiagramBranch& branch,
                                        const geometry::Pose2& T_robot_laser) {
  points_.clear();
  confirmed_.clear();
  for (const voronoi::DiagramPoint& point : diagram.points_of(branch)) {
    points_.push_back({T_robot_laser * point.position_m, point.clearance_m});
    confirmed_.push_back(diagram.is_virtual || confirms(point.clearance_m, point.hidden_m) ? 1 : 0);
  }
}

/// 5.5: walks outward from the real node, or from the point nearest to the robot, and cuts a loose
/// end before the first step longer than the threshold. Compares successive points, not each with
/// the start (docs/algorithms.md, "Local topo-geometric map", errata).
void LocalMapBuilder::Work::cut_far_points(const DiagramBranch& branch) {
  const bool loose_a = branch.node_a == DiagramBranch::kLoose;
  const bool loose_b = branch.node_b == DiagramBranch::kLoose;
  if (!loose_a && !loose_b) return;
  const auto apart = [&](std::size_t i) {
    return (points_[i + 1].position_m - points_[i].position_m).norm() > config_.separated_m;
  };
  const std::size_t start =
      loose_a && loose_b ? nearest_to_robot(points_) : (loose_a ? points_.size() - 1 : 0);
  std::size_t first = start;
  std::size_t last = start;
  while (first > 0 && !(loose_a && apart(first - 1))) --first;
  while (last + 1 < points_.size() && !(loose_b && apart(last))) ++last;
  const auto keep = [&](auto& values) {
    values.erase(values.begin() + static_cast<std::ptrdiff_t>(last) + 1, values.end());
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first));
  };
  keep(points_);
  keep(confirmed_);
}

std::size_t LocalMapBuilder::Work::end_of_stretch(std::size_t first) const {
  std::size_t end = first;
  while (end < confirmed_.size() && confirmed_[end] == confirmed_[first]) ++end;
  return end;
}

/// Gives stretches of the given kind that are too short the kind of their neighbours.
void LocalMapBuilder::Work::absorb_short_stretches(bool short_ones_are) {
  const char kind = short_ones_are ? 1 : 0;
  for (std::size_t first = 0; first < confirmed_.size();) {
    const std::size_t end = end_of_stretch(first);
    double length_m = 0.0;
    for (std::size_t i = std::max<std::size_t>(first, 1); i < end; ++i) {
      length_m += (points_[i].position_m - points_[i - 1].position_m).norm();
    }
    const bool alone = first == 0 && end == confirmed_.size();
    if (confirmed_[first] == kind && !alone && length_m < config_.min_stretch_m) {
      std::fill(confirmed_.begin() + static_cast<std::ptrdiff_t>(first),
                confirmed_.begin() + static_cast<std::ptrdiff_t>(end), short_ones_are ? 0 : 1);
    }
    first = end;
  }
}

/// Finds the states of the branch and the borders of its confirmed stretches. The branch passes the
/// exact places of its states.
void LocalMapBuilder::Work::find_cuts() {
  cuts_.clear();
  absorb_short_stretches(false);
  absorb_short_stretches(true);
  if (config_.find_states) {
    const auto states = config_.state_rule == StateRule::kSlopes
                            ? state_finder_.find_slope_changes(points_, confirmed_, config_)
                            : state_finder_.find(points_, confirmed_, config_);
    cuts_.assign(states.begin(), states.end());
    for (const BranchState& state : cuts_) points_[state.point] = state.at;
  }
  for (std::size_t i = 1; i + 1 < points_.size(); ++i) {
    // The point on the border is the last confirmed one.
    const bool border = confirmed_[i] != 0 && (confirmed_[i - 1] == 0 || confirmed_[i + 1] == 0);
    if (border) cuts_.push_back({i, NodeKind::kFictitious, points_[i]});
  }
  std::ranges::sort(cuts_, [](const BranchState& a, const BranchState& b) {
    return a.point != b.point ? a.point < b.point : a.kind > b.kind;  // states before borders
  });
  const auto same = [](const BranchState& a, const BranchState& b) { return a.point == b.point; };
  cuts_.erase(std::unique(cuts_.begin(), cuts_.end(), same), cuts_.end());
}

void LocalMapBuilder::Work::add_piece(const DiagramBranch& from, bool is_virtual,
                                      std::uint32_t node_a, std::uint32_t node_b, std::size_t first,
                                      std::size_t last) {
  const auto id = static_cast<std::uint32_t>(branches_.size());
  LocalBranch& branch = branches_.add();
  branch.id = id;
  branch.node_a = node_a;
  branch.node_b = node_b;
  branch.base_groups = from.base_groups;
  branch.is_virtual = is_virtual;
  // The ends can have the neighbours' kind; the points in between are all of one kind.
  branch.confirmed = confirmed_[first] != 0 && confirmed_[last] != 0 &&
                     confirmed_[first + (last - first) / 2] != 0;
  branch.points.assign(points_.begin() + static_cast<std::ptrdiff_t>(first),
                       points_.begin() + static_cast<std::ptrdiff_t>(last) + 1);
}

/// Adds a branch, divided at its states and at the borders of its confirmed stretches.
void LocalMapBuilder::Work::add_branch(const DiagramBranch& from, bool is_virtual) {
  const NodeKind end_kind = is_virtual ? NodeKind::kVirtual : NodeKind::kFictitious;
  const auto end_node = [&](std::uint32_t node, const BranchPoint& at) {
    return node == DiagramBranch::kLoose ? add_node(end_kind, at, from.base_groups) : node;
  };
  const std::uint32_t node_a = end_node(from.node_a, points_.front());
  const std::uint32_t node_b = end_node(from.node_b, points_.back());
  cuts_.clear();
  if (!is_virtual) find_cuts();
  std::uint32_t before = node_a;
  std::size_t first = 0;
  for (const BranchState& cut : cuts_) {
    const std::uint32_t node = add_node(cut.kind, points_[cut.point], from.base_groups);
    add_piece(from, is_virtual, before, node, first, cut.point);
    before = node;
    first = cut.point;
  }
  add_piece(from, is_virtual, before, node_b, first, points_.size() - 1);
}

/// Marks the graph nearest to the robot (def. 5.2.2). Loose ends of the same base groups nearer to
/// each other than the threshold of 5.5 are ends of one branch that the laser did not see whole.
void LocalMapBuilder::Work::mark_main_graph(LocalMap& map) {
  components_.reset(map.nodes.size());
  for (const LocalBranch& branch : map.branches) components_.join(branch.node_a, branch.node_b);
  for (const LocalNode& a : map.nodes) {
    if (a.kind != NodeKind::kFictitious) continue;
    for (std::size_t i = a.id + 1; i < map.nodes.size(); ++i) {
      const LocalNode& b = map.nodes[i];
      if (b.kind == NodeKind::kFictitious && a.base_groups == b.base_groups &&
          (a.position_m - b.position_m).norm() <= config_.separated_m) {
        components_.join(a.id, b.id);
      }
    }
  }
  const std::uint32_t main = find_main_graph(map);
  for (LocalNode& node : map.nodes) node.in_main_graph = components_.root(node.id) == main;
  for (LocalBranch& branch : map.branches) {
    branch.in_main_graph = map.nodes[branch.node_a].in_main_graph;
  }
}

/// Root of the component with the branch nearest to the robot among those that are long enough, or
/// among all if none is.
std::uint32_t LocalMapBuilder::Work::find_main_graph(const LocalMap& map) {
  length_m_.assign(map.nodes.size(), 0.0);
  for (const LocalBranch& branch : map.branches) {
    double& length_m = length_m_[components_.root(branch.node_a)];
    for (std::size_t i = 1; i < branch.points.size(); ++i) {
      length_m += (branch.points[i].position_m - branch.points[i - 1].position_m).norm();
    }
  }
  bool best_is_long = false;
  double best_sq = std::numeric_limits<double>::infinity();
  std::uint32_t best = 0;
  for (const LocalBranch& branch : map.branches) {
    const std::uint32_t root = components_.root(branch.node_a);
    const bool is_long = length_m_[root] >= config_.min_main_graph_m;
    if (best_is_long && !is_long) continue;
    const double sq = branch.points[nearest_to_robot(branch.points)].position_m.squaredNorm();
    if (sq >= best_sq && is_long == best_is_long) continue;
    best_is_long = is_long;
    best_sq = sq;
    best = root;
  }
  return best;
}

void LocalMapBuilder::Work::remove_off_main_graph(LocalMap& map) {
  kept_.clear();
  std::uint32_t nodes = 0;
  for (const LocalNode& node : map.nodes) {
    kept_.push_back(nodes);
    if (node.in_main_graph) ++nodes;
  }
  std::erase_if(map.nodes, [](const LocalNode& node) { return !node.in_main_graph; });
  std::erase_if(map.branches, [](const LocalBranch& branch) { return !branch.in_main_graph; });
  for (LocalNode& node : map.nodes) node.id = kept_[node.id];
  std::uint32_t branches = 0;
  for (LocalBranch& branch : map.branches) {
    branch.id = branches++;
    branch.node_a = kept_[branch.node_a];
    branch.node_b = kept_[branch.node_b];
  }
}

void LocalMapBuilder::Work::build(const LocalVoronoiDiagram& diagram, const scan::Scan& scan,
                                  const geometry::Pose2& T_robot_laser, LocalMap& out) {
  out.T_robot_laser = T_robot_laser;
  nodes_.open(out.nodes);
  branches_.open(out.branches);
  add_diagram_nodes(diagram, T_robot_laser);
  for (const DiagramBranch& branch : diagram.branches) {
    take_points(diagram, branch, T_robot_laser);
    cut_far_points(branch);
    if (points_.size() >= 2) add_branch(branch, diagram.is_virtual);
  }
  nodes_.close();
  branches_.close();
  mark_main_graph(out);
  if (config_.remove_off_main_graph) remove_off_main_graph(out);
  scan_points(scan, T_robot_laser, config_.points_range_m, out.points);
}

LocalMapBuilder::LocalMapBuilder(const LocalMapConfig& config)
    : work_(std::make_unique<Work>(config)) {
  check(config);
}
LocalMapBuilder::~LocalMapBuilder() = default;
LocalMapBuilder::LocalMapBuilder(LocalMapBuilder&&) noexcept = default;
LocalMapBuilder& LocalMapBuilder::operator=(LocalMapBuilder&&) noexcept = default;

void LocalMapBuilder::build(const LocalVoronoiDiagram& diagram, const scan::Scan& scan,
                            const geometry::Pose2& T_robot_laser, LocalMap& out) {
  work_->build(diagram, scan, T_robot_laser, out);
}

void scan_points(const scan::Scan& scan, const geometry::Pose2& T_robot_laser, double range_limit_m,
                 std::vector<ScanPoint>& points) {
  points.clear();
  points.reserve(scan.ranges_m.size());
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const auto range_m = static_cast<double>(scan.ranges_m[i]);
    if (!(range_m > 0.0 && range_m <= range_limit_m)) continue;
    const auto [sin, cos] =
        geometry::sincos(scan.angle_min_rad + static_cast<double>(i) * scan.angle_step_rad);
    const Eigen::Vector2d point_m = T_robot_laser * Eigen::Vector2d{range_m * cos, range_m * sin};
    points.push_back({static_cast<float>(point_m.x()), static_cast<float>(point_m.y())});
  }
}

std::vector<ScanPoint> scan_points(const scan::Scan& scan, const geometry::Pose2& T_robot_laser,
                                   double range_limit_m) {
  std::vector<ScanPoint> points;
  scan_points(scan, T_robot_laser, range_limit_m, points);
  return points;
}

void build_local_map(const LocalVoronoiDiagram& diagram, const scan::Scan& scan,
                     const geometry::Pose2& T_robot_laser, const LocalMapConfig& config,
                     LocalMap& out) {
  LocalMapBuilder(config).build(diagram, scan, T_robot_laser, out);
}

}  // namespace topogeo::topomap
