#include "pair_fusion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "node_fusion.hpp"

namespace topogeo::topomap {

using geometry::Pose2;

namespace {

// Choices for "near and of similar inclination" (def. 6.2.4), which the thesis leaves open. Fixed,
// because the form is only for comparison.
constexpr double kSameInclination = 0.87;  // cosine
constexpr double kCoincidingShare = 0.5;   // of the points of the shorter one

Eigen::Vector2d inclination_at(const std::vector<BranchPoint>& points, std::size_t i) {
  const std::size_t before = i >= 2 ? i - 2 : 0;
  const std::size_t after = std::min(points.size() - 1, i + 2);
  return (points[after].position_m - points[before].position_m).normalized();
}

}  // namespace

/// One view in the map frame and its field of view (def. 7.3.1).
struct PairFusion::View {
  Pose2 T_map_robot;
  Pose2 T_robot_map;
  Eigen::Vector2d low_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d high_m = Eigen::Vector2d::Zero();
  Sighting sighting;
  std::set<std::uint32_t> joined;  // nodes of the map that this view was joined with
  std::uint32_t first_branch;      // branches of this view have ids from here on

  View(const LocalMap& map, const Pose2& pose, const Sighting& of, std::uint32_t next_branch)
      : T_map_robot(pose),
        T_robot_map(geometry::inverse(pose)),
        sighting(of),
        first_branch(next_branch) {
    const auto include = [this](const Eigen::Vector2d& p) {
      low_m = low_m.cwiseMin(p);
      high_m = high_m.cwiseMax(p);
    };
    for (const LocalNode& node : map.nodes) include(node.position_m);
    for (const LocalBranch& branch : map.branches) {
      for (const BranchPoint& point : branch.points) include(point.position_m);
    }
  }

  [[nodiscard]] bool contains(const Eigen::Vector2d& point_map_m) const {
    const Eigen::Vector2d p = T_robot_map * point_map_m;
    return (low_m.array() <= p.array()).all() && (p.array() <= high_m.array()).all();
  }
};

void PairFusion::add(const LocalMap& map, const Pose2& T_map_robot, const Sighting& sighting) {
  View view(map, T_map_robot, sighting, next_branch_);
  std::vector<std::uint32_t> ids(map.nodes.size(), 0);
  for (const LocalNode& node : map.nodes) {
    if (!node.in_main_graph || node.kind == NodeKind::kVirtual) continue;
    const BranchPoint at{T_map_robot * node.position_m, node.clearance_m};
    ids[node.id] =
        node.kind == NodeKind::kFictitious ? add_node(node.kind, at, view) : join_node(node, view);
  }
  for (const LocalBranch& branch : map.branches) {
    if (!branch.in_main_graph || branch.is_virtual || branch.points.size() < 2) continue;
    MapBranch seen;
    seen.node_a = ids[branch.node_a];
    seen.node_b = ids[branch.node_b];
    seen.observations = sighting.views;
    seen.last_seen_ns = sighting.last_ns;
    for (const BranchPoint& point : branch.points) {
      seen.points.push_back({T_map_robot * point.position_m, point.clearance_m});
    }
    join_branch(std::move(seen), view);
  }
}

std::uint32_t PairFusion::add_node(NodeKind kind, const BranchPoint& at, const View& view) {
  nodes_.push_back({next_node_, kind, at.position_m, at.clearance_m, view.sighting.views,
                    view.sighting.last_ns});
  return next_node_++;
}

std::optional<std::size_t> PairFusion::nearest_equivalent(const MapNode& node,
                                                          const View& view) const {
  std::optional<std::size_t> best;
  double best_m = config_.node_merge_m;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const MapNode& known = nodes_[i];
    const double distance_m = (known.position_m - node.position_m).norm();
    if (known.id == node.id || distance_m >= best_m || !compatible(known.kind, node.kind) ||
        known.kind == NodeKind::kFictitious || view.joined.contains(known.id) ||
        std::fabs(known.clearance_m - node.clearance_m) > config_.clearance_tolerance_m ||
        !view.contains(known.position_m)) {
      continue;
    }
    best_m = distance_m;
    best = i;
  }
  return best;
}

// Applies 7.25 and 7.26 to each equivalent node in turn: one between two that were apart joins all
// three (fig. 8.10).
std::uint32_t PairFusion::join_node(const LocalNode& node, View& view) {
  MapNode seen{next_node_,       node.kind,           view.T_map_robot * node.position_m,
               node.clearance_m, view.sighting.views, view.sighting.last_ns};
  bool joined = false;
  while (const std::optional<std::size_t> found = nearest_equivalent(seen, view)) {
    const MapNode known = nodes_[*found];
    nodes_.erase(nodes_.begin() + static_cast<std::ptrdiff_t>(*found));
    for (MapBranch& branch : branches_) {
      if (joined && branch.node_a == known.id) branch.node_a = seen.id;
      if (joined && branch.node_b == known.id) branch.node_b = seen.id;
    }
    seen.position_m = 0.5 * (seen.position_m + known.position_m);
    seen.clearance_m = 0.5 * (seen.clearance_m + known.clearance_m);
    seen.observations += known.observations;
    seen.last_seen_ns = std::max(seen.last_seen_ns, known.last_seen_ns);
    if (!joined) {
      seen.id = known.id;
      seen.kind = known.kind;
    }
    joined = true;
  }
  if (!joined) ++next_node_;
  view.joined.insert(seen.id);
  const auto at = std::lower_bound(nodes_.begin(), nodes_.end(), seen.id,
                                   [](const MapNode& n, std::uint32_t id) { return n.id < id; });
  nodes_.insert(at, seen);
  return seen.id;
}

// Branches of one view are not joined with each other: a short one that continues a long one would
// replace it.
bool PairFusion::equivalent(const MapBranch& known, const MapBranch& seen, const View& view) const {
  if (known.id >= view.first_branch) return false;
  std::size_t in_view = 0;
  for (const BranchPoint& point : known.points) {
    if (view.contains(point.position_m)) ++in_view;
  }
  if (in_view == 0) return false;
  const double reach2 = config_.vote_radius_m * config_.vote_radius_m;
  std::size_t coinciding = 0;
  for (std::size_t i = 0; i < seen.points.size(); ++i) {
    const Eigen::Vector2d direction = inclination_at(seen.points, i);
    for (std::size_t k = 0; k < known.points.size(); ++k) {
      const BranchPoint& other = known.points[k];
      if ((other.position_m - seen.points[i].position_m).squaredNorm() > reach2 ||
          std::fabs(other.clearance_m - seen.points[i].clearance_m) >
              config_.clearance_tolerance_m ||
          std::fabs(inclination_at(known.points, k).dot(direction)) < kSameInclination) {
        continue;
      }
      ++coinciding;
      break;
    }
  }
  return static_cast<double>(coinciding) >=
         kCoincidingShare * static_cast<double>(std::min(in_view, seen.points.size()));
}

// Reduces a branch that is replaced within the field of view to its parts outside.
void PairFusion::keep_outside(std::size_t known, const View& view) {
  const auto outside = [&view](const BranchPoint& p) { return !view.contains(p.position_m); };
  MapBranch& branch = branches_[known];
  const auto first = std::find_if_not(branch.points.begin(), branch.points.end(), outside);
  const auto last = std::find_if_not(branch.points.rbegin(), branch.points.rend(), outside).base();
  const std::vector<BranchPoint> before(branch.points.begin(), first);
  const std::vector<BranchPoint> after(last, branch.points.end());
  MapBranch rest = branch;
  branch.points = before;
  if (before.size() > 1) branch.node_b = add_node(NodeKind::kFictitious, before.back(), view);
  if (after.size() < 2) return;
  rest.points = after;
  rest.node_a = add_node(NodeKind::kFictitious, after.front(), view);
  rest.id = next_branch_++;
  branches_.push_back(std::move(rest));
}

// 7.27: joins the points of both outside the common field of view with those of the newer one
// inside.
void PairFusion::join_branch(MapBranch seen, const View& view) {
  std::optional<MapBranch> longest;
  for (std::size_t i = branches_.size(); i-- > 0;) {
    if (branches_[i].points.size() < 2 || !equivalent(branches_[i], seen, view)) continue;
    if (!longest || branches_[i].points.size() > longest->points.size()) {
      longest = branches_[i];
    }
    keep_outside(i, view);
    seen.observations += branches_[i].observations;
  }
  if (longest) {
    // Its parts outside were kept as separate branches; here they are joined with the new one.
    std::vector<BranchPoint> points = seen.points;
    std::vector<std::uint32_t> ends{seen.node_a, seen.node_b};
    const Eigen::Vector2d along =
        longest->points.back().position_m - longest->points.front().position_m;
    if (along.dot(points.back().position_m - points.front().position_m) < 0.0) {
      std::reverse(points.begin(), points.end());
      std::swap(ends[0], ends[1]);
    }
    for (MapBranch& part : branches_) {
      if (part.points.size() < 2) continue;
      const bool is_before = part.id == longest->id;
      const bool is_after = !is_before && part.node_b == longest->node_b &&
                            part.points.back().position_m == longest->points.back().position_m;
      if (is_before) {
        points.insert(points.begin(), part.points.begin(), part.points.end());
        ends[0] = part.node_a;
      } else if (is_after) {
        points.insert(points.end(), part.points.begin(), part.points.end());
        ends[1] = part.node_b;
      } else {
        continue;
      }
      part.points.clear();
    }
    seen.points = std::move(points);
    seen.node_a = ends[0];
    seen.node_b = ends[1];
  }
  std::erase_if(branches_, [](const MapBranch& branch) { return branch.points.size() < 2; });
  seen.id = next_branch_++;
  branches_.push_back(std::move(seen));
}

GlobalMap PairFusion::map() const {
  GlobalMap map;
  map.branches = branches_;
  std::set<std::uint32_t> used;
  for (MapBranch& branch : map.branches) {
    used.insert({branch.node_a, branch.node_b});
    for (const auto& [id, point] : {std::pair{branch.node_a, &branch.points.front()},
                                    std::pair{branch.node_b, &branch.points.back()}}) {
      const auto node =
          std::lower_bound(nodes_.begin(), nodes_.end(), id,
                           [](const MapNode& n, std::uint32_t wanted) { return n.id < wanted; });
      point->position_m = node->position_m;
    }
  }
  for (const MapNode& node : nodes_) {
    if (node.kind != NodeKind::kFictitious || used.contains(node.id)) map.nodes.push_back(node);
  }
  std::sort(map.branches.begin(), map.branches.end(),
            [](const MapBranch& a, const MapBranch& b) { return a.id < b.id; });
  return map;
}

}  // namespace topogeo::topomap
