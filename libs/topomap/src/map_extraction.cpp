#include "map_extraction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "ridge_refinement.hpp"

namespace topogeo::topomap {
namespace {

/// Ids from here on: nodes without a fused node and branches without an anchor.
constexpr std::uint32_t kFirstUnfusedId = 1U << 30U;

class Extraction {
 public:
  Extraction(const RidgeGraph& ridge, const NodeFusion& fusion, const BranchNames& names,
             const GlobalMapConfig& config)
      : ridge_(ridge), fusion_(fusion), names_(names), config_(config) {}

  GlobalMap run() {
    name_ridge_nodes();
    place_on_branches();
    name_branches();
    smooth_branches();
    std::sort(map_.nodes.begin(), map_.nodes.end(),
              [](const MapNode& a, const MapNode& b) { return a.id < b.id; });
    std::sort(map_.branches.begin(), map_.branches.end(),
              [](const MapBranch& a, const MapBranch& b) { return a.id < b.id; });
    return std::move(map_);
  }

 private:
  // A branch during the division at doors and the like; points without the two nodes.
  struct Piece {
    MapNode a;
    MapNode b;
    std::vector<RidgePoint> points;
  };

  [[nodiscard]] bool accepted(const FusedNode& n) const {
    return n.observations >= config_.min_observations &&
           n.weight_for >= config_.keep_share * (n.weight_for + n.weight_against);
  }

  // The most observed fused node of the wanted kind near a place; each is used once.
  template <typename Wanted>
  std::optional<std::uint32_t> claim(const RidgePoint& place, double radius_m, Wanted wanted) {
    std::optional<std::uint32_t> best;
    for (const std::uint32_t id : fusion_.near(place.position_m, radius_m)) {
      const FusedNode& n = fusion_.nodes()[id];
      if (taken_.contains(id) || !wanted(n.kind)) continue;
      if (!best || n.observations > fusion_.nodes()[*best].observations) best = id;
    }
    if (best) taken_.insert(*best);
    return best;
  }

  [[nodiscard]] MapNode fused(std::uint32_t id) const {
    const FusedNode& n = fusion_.nodes()[id];
    return {id, n.kind, n.position_m, n.clearance_m, n.observations, n.last_seen_ns};
  }

  MapNode unfused(const RidgePoint& place, NodeKind kind) {
    std::uint32_t id = kFirstUnfusedId + place.first_seen;
    while (!taken_.insert(id).second) ++id;
    return {id, kind, place.position_m, place.clearance_m, place.views, place.last_seen_ns};
  }

  void name_ridge_nodes() {
    std::vector<std::uint32_t> degree(ridge_.nodes.size(), 0);
    for (const RidgeEdge& e : ridge_.edges) {
      ++degree[e.a];
      ++degree[e.b];
    }
    // Best supported places first: the better of two junctions near one fused node gets it.
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 0; i < ridge_.nodes.size(); ++i) {
      if (degree[i] > 0) order.push_back(i);
    }
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tuple(degree[b] > 2, ridge_.nodes[b].views, a) <
             std::tuple(degree[a] > 2, ridge_.nodes[a].views, b);
    });
    std::vector<MapNode> named(ridge_.nodes.size());
    for (const std::uint32_t i : order) named[i] = name(ridge_.nodes[i], degree[i]);
    for (const std::uint32_t i : order) map_.nodes.push_back(named[i]);
    for (const RidgeEdge& e : ridge_.edges) pieces_.push_back({named[e.a], named[e.b], e.points});
  }

  MapNode name(const RidgePoint& place, std::uint32_t degree) {
    const bool junction = degree > 2;
    const auto wanted = [junction](NodeKind k) { return !junction || k == NodeKind::kReal; };
    // Only a node right there explains a free end.
    const double radius = junction ? config_.node_merge_m : 0.5 * config_.node_merge_m;
    if (const std::optional<std::uint32_t> id = claim(place, radius, wanted)) return fused(*id);
    return unfused(place, junction ? NodeKind::kReal : NodeKind::kFictitious);
  }

  // Divides branches at the doors, narrowings and hall-corridor passages on them.
  void place_on_branches() {
    std::vector<std::uint32_t> order;
    for (std::uint32_t id = 0; id < fusion_.nodes().size(); ++id) {
      const FusedNode& n = fusion_.nodes()[id];
      if (n.kind != NodeKind::kReal && !taken_.contains(id) && accepted(n)) order.push_back(id);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return fusion_.nodes()[a].observations > fusion_.nodes()[b].observations;
    });
    for (const std::uint32_t id : order) cut_at(id);
  }

  void cut_at(std::uint32_t id) {
    const FusedNode& n = fusion_.nodes()[id];
    for (const MapNode& other : map_.nodes) {
      if ((other.position_m - n.position_m).norm() < config_.node_merge_m) return;
    }
    double best_m = config_.node_merge_m;
    std::size_t best_piece = 0;
    std::optional<std::size_t> best_point;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      for (std::size_t k = 0; k < pieces_[i].points.size(); ++k) {
        const double distance = (pieces_[i].points[k].position_m - n.position_m).norm();
        if (distance >= best_m) continue;
        best_m = distance;
        best_piece = i;
        best_point = k;
      }
    }
    if (!best_point) return;
    taken_.insert(id);
    MapNode node = fused(id);
    map_.nodes.push_back(node);
    Piece& first = pieces_[best_piece];
    const auto at = first.points.begin() + static_cast<std::ptrdiff_t>(*best_point);
    Piece second{node, first.b, {at + 1, first.points.end()}};
    first.points.erase(at, first.points.end());
    first.b = node;
    pieces_.push_back(std::move(second));
  }

  // For each piece the lowest of the anchors that are nearest to it, if any.
  [[nodiscard]] std::vector<std::optional<std::uint32_t>> anchors_of_pieces() const {
    std::vector<std::optional<std::uint32_t>> lowest(pieces_.size());
    for (std::uint32_t id = 0; id < names_.anchors().size(); ++id) {
      double nearest = BranchNames::kReach_m * BranchNames::kReach_m;
      std::optional<std::size_t> owner;
      for (std::size_t i = 0; i < pieces_.size(); ++i) {
        for (const RidgePoint& p : pieces_[i].points) {
          const double d2 = (p.position_m - names_.anchors()[id]).squaredNorm();
          if (d2 >= nearest) continue;
          nearest = d2;
          owner = i;
        }
      }
      if (owner && !lowest[*owner]) lowest[*owner] = id;
    }
    return lowest;
  }

  void name_branches() {
    const std::vector<std::optional<std::uint32_t>> anchors = anchors_of_pieces();
    std::set<std::uint32_t> used;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const Piece& piece = pieces_[i];
      std::uint32_t first_block = kFirstUnfusedId - 1;
      MapBranch branch;
      branch.points.push_back({piece.a.position_m, piece.a.clearance_m});
      for (const RidgePoint& p : piece.points) {
        first_block = std::min(first_block, p.first_seen);
        branch.observations = std::max(branch.observations, p.views);
        branch.last_seen_ns = std::max(branch.last_seen_ns, p.last_seen_ns);
        branch.points.push_back({p.position_m, p.clearance_m});
      }
      branch.points.push_back({piece.b.position_m, piece.b.clearance_m});
      branch.id = anchors[i].value_or(kFirstUnfusedId + first_block);
      while (!used.insert(branch.id).second) ++branch.id;
      branch.node_a = piece.a.id;
      branch.node_b = piece.b.id;
      map_.branches.push_back(std::move(branch));
    }
  }

  // Removes the steps of the grid from the curves; the ends stay at their nodes.
  void smooth_branches() {
    constexpr int kPasses = 6;  // fixed: enough for steps of one cell
    for (MapBranch& branch : map_.branches) {
      std::vector<BranchPoint>& p = branch.points;
      for (int pass = 0; pass < kPasses; ++pass) {
        BranchPoint previous = p.front();
        for (std::size_t i = 1; i + 1 < p.size(); ++i) {
          const BranchPoint here = p[i];
          p[i].position_m =
              0.25 * previous.position_m + 0.5 * here.position_m + 0.25 * p[i + 1].position_m;
          p[i].clearance_m =
              0.25 * previous.clearance_m + 0.5 * here.clearance_m + 0.25 * p[i + 1].clearance_m;
          previous = here;
        }
      }
    }
  }

  const RidgeGraph& ridge_;
  const NodeFusion& fusion_;
  const BranchNames& names_;
  const GlobalMapConfig& config_;
  GlobalMap map_;
  std::vector<Piece> pieces_;
  std::set<std::uint32_t> taken_;
};

}  // namespace

GlobalMap extract_map(const RidgeGraph& ridge, const NodeFusion& nodes, const BranchNames& names,
                      const GlobalMapConfig& config) {
  return Extraction(ridge, nodes, names, config).run();
}

}  // namespace topogeo::topomap
