#include "node_fusion.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace topogeo::topomap {

bool compatible(NodeKind a, NodeKind b) {
  const auto narrow = [](NodeKind k) { return k == NodeKind::kDoor || k == NodeKind::kNarrowing; };
  return a == b || (narrow(a) && narrow(b));
}

void NodeFusion::add(const LocalMap& map, const geometry::Pose2& T_map_robot,
                     const SeenRegion& view, const Sighting& sighting) {
  ++view_;
  for (const LocalNode& n : map.nodes) {
    if (!n.in_main_graph || n.kind == NodeKind::kFictitious || n.kind == NodeKind::kVirtual) {
      continue;
    }
    FusedNode seen;
    seen.kind = n.kind;
    seen.position_m = T_map_robot * n.position_m;
    seen.clearance_m = n.clearance_m;
    seen.observations = sighting.views;
    seen.last_seen_ns = sighting.last_ns;
    if (const std::optional<std::uint32_t> id = equivalent(seen)) {
      merge(*id, seen);
    } else {
      const auto added = static_cast<std::uint32_t>(nodes_.size());
      seen.weight_for = 1.0;
      seen.last_view = view_;
      nodes_.push_back(seen);
      tree_.insert(Entry{{seen.position_m.x(), seen.position_m.y()}, added});
    }
  }
  vote_against(T_map_robot, map, view);
}

std::vector<std::uint32_t> NodeFusion::near(const Eigen::Vector2d& point_m, double radius_m) const {
  using Box = boost::geometry::model::box<IndexPoint>;
  const Box box({point_m.x() - radius_m, point_m.y() - radius_m},
                {point_m.x() + radius_m, point_m.y() + radius_m});
  std::vector<std::uint32_t> found;
  for (auto it = tree_.qbegin(boost::geometry::index::intersects(box)); it != tree_.qend(); ++it) {
    if ((nodes_[it->second].position_m - point_m).norm() <= radius_m) found.push_back(it->second);
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::optional<std::uint32_t> NodeFusion::equivalent(const FusedNode& seen) const {
  std::optional<std::uint32_t> best;
  double best_m = config_.node_merge_m;
  for (const std::uint32_t id : near(seen.position_m, config_.node_merge_m)) {
    const FusedNode& known = nodes_[id];
    if (!compatible(known.kind, seen.kind) ||
        std::fabs(known.clearance_m - seen.clearance_m) > config_.clearance_tolerance_m) {
      continue;
    }
    const double distance = (known.position_m - seen.position_m).norm();
    if (distance < best_m) {
      best_m = distance;
      best = id;
    }
  }
  return best;
}

void NodeFusion::merge(std::uint32_t id, const FusedNode& seen) {
  FusedNode& known = nodes_[id];
  // Several neighbouring nodes of one view are one observation; the first one counts.
  if (known.last_view == view_) return;
  known.last_view = view_;
  tree_.remove(Entry{{known.position_m.x(), known.position_m.y()}, id});
  known.observations += seen.observations;
  known.last_seen_ns = std::max(known.last_seen_ns, seen.last_seen_ns);
  known.weight_for += 1.0;
  const double share = static_cast<double>(seen.observations) / known.observations;
  known.position_m += share * (seen.position_m - known.position_m);
  known.clearance_m += share * (seen.clearance_m - known.clearance_m);
  tree_.insert(Entry{{known.position_m.x(), known.position_m.y()}, id});
  fade(known);
}

void NodeFusion::vote_against(const geometry::Pose2& T_map_robot, const LocalMap& map,
                              const SeenRegion& view) {
  double reach_m = 0.0;
  for (const ScanPoint& p : map.points) {
    reach_m = std::max(reach_m, Eigen::Vector2d(p.x_m, p.y_m).norm());
  }
  const geometry::Pose2 T_robot_map = inverse(T_map_robot);
  for (const std::uint32_t id : near(T_map_robot.position_m(), reach_m)) {
    FusedNode& known = nodes_[id];
    if (known.last_view == view_) continue;
    if (!view.certain(T_robot_map * known.position_m, known.clearance_m)) continue;
    known.weight_against += 1.0;
    fade(known);
  }
}

void NodeFusion::fade(FusedNode& node) const {
  const double all = node.weight_for + node.weight_against;
  if (all <= config_.memory_views) return;
  node.weight_for *= config_.memory_views / all;
  node.weight_against *= config_.memory_views / all;
}

}  // namespace topogeo::topomap
