#include "topogeo/exchange/route_network.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <span>

#include "topogeo/exchange/place_graph.hpp"
#include "topogeo/geometry/segment.hpp"
#include "topogeo/support/check_range.hpp"
#include "topogeo/support/format.hpp"

#include "graph_parts.hpp"
#include "segments.hpp"

namespace topogeo::exchange {
namespace {

using topomap::BranchPoint;

double least_clearance(std::span<const BranchPoint> points) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const BranchPoint& p : points) least_m = std::min(least_m, p.clearance_m);
  return least_m;
}

/// Whether the robot's centre may move along the line.
bool is_free(const planning::FreeSpace& space, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  // Four samples per cell: a line may cut off less of a forbidden cell's corner.
  const int steps =
      static_cast<int>(std::ceil(4.0 * distance(a, b) / space.frame().resolution_m)) + 1;
  for (int i = 0; i <= steps; ++i) {
    const auto cell = space.frame().cell_of(a + (b - a) * (static_cast<double>(i) / steps));
    if (!cell || !space.passable(*cell)) return false;
  }
  return true;
}

class Builder {
 public:
  Builder(const topomap::GlobalMap& map, const planning::FreeSpace* space,
          const NetworkSettings& settings)
      : map_(map), space_(space), settings_(settings) {
    for (const topomap::MapNode& node : map.nodes) {
      node_of_[node.id] = static_cast<std::uint32_t>(network_.nodes.size());
      network_.nodes.push_back({node.position_m, node.clearance_m,
                                static_cast<std::uint32_t>(network_.nodes.size()), std::nullopt});
    }
  }

  RouteNetwork build(const storage::MapDrawing& drawing) {
    const std::set<std::uint32_t> joining = joining_virtual_branches(map_);
    for (const topomap::MapBranch& branch : map_.branches) {
      if (branch.is_virtual) joining_ += joining.contains(branch.id);
      if (branch.is_virtual && !settings_.with_virtual && !joining.contains(branch.id)) {
        ++virtual_;
      } else {
        add_branch(branch);
      }
    }
    for (std::size_t i = 0; i < drawing.places.size(); ++i) {
      add_place(drawing.places[i], static_cast<std::uint32_t>(i));
    }
    add_notes();
    keep_rules(drawing.zones);
    check_on_grid();
    return std::move(network_);
  }

 private:
  /// Parts of a branch that are wide enough become pieces; narrow ones are left out.
  void add_branch(const topomap::MapBranch& branch) {
    const std::vector<BranchPoint>& points = branch.points;
    const bool unknown = lacks_clearance(branch);
    if (unknown) ++unknown_;
    const auto passable = [&](std::size_t i) {
      return unknown || points[i].clearance_m >= settings_.robot_radius_m;
    };
    std::size_t begin = 0;
    while (begin + 1 < points.size()) {
      std::size_t end = begin;
      while (end + 1 < points.size() && passable(end) && passable(end + 1)) ++end;
      if (end == begin) {
        narrow_.push_back(branch.id);
        ++begin;
        continue;
      }
      std::uint32_t from = node_at(branch, begin);
      for (const std::size_t bend : bends(points, begin, end, unknown)) {
        const std::uint32_t to = node_at(branch, bend);
        const std::span<const BranchPoint> piece(&points[begin], bend - begin + 1);
        const double clearance_m = unknown ? 0.0 : least_clearance(piece) - deviation(piece).second;
        // A branch that returns to its node within the tolerance leads nowhere.
        if (from != to) network_.pieces.push_back({from, to, clearance_m, branch.id, {}});
        from = to;
        begin = bend;
      }
    }
  }

  std::uint32_t node_at(const topomap::MapBranch& branch, std::size_t point) {
    if (point == 0) return node_of_.at(branch.node_a);
    if (point + 1 == branch.points.size()) return node_of_.at(branch.node_b);
    return add_node({branch.points[point].position_m, branch.points[point].clearance_m,
                     std::nullopt, std::nullopt});
  }

  std::uint32_t add_node(const NetworkNode& node) {
    network_.nodes.push_back(node);
    return static_cast<std::uint32_t>(network_.nodes.size() - 1);
  }

  /// The point farthest from the line between the ends, and its distance.
  static std::pair<std::size_t, double> deviation(std::span<const BranchPoint> points) {
    std::pair<std::size_t, double> farthest{0, 0.0};
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      const auto on_line = geometry::nearest_on_segment(
          points.front().position_m, points.back().position_m, points[i].position_m);
      const double away_m = distance(on_line.point_m, points[i].position_m);
      if (away_m > farthest.second) farthest = {i, away_m};
    }
    return farthest;
  }

  /// Ends of the pieces of points[begin..end], including `end`. Without known clearances only the
  /// tolerance counts.
  [[nodiscard]] std::vector<std::size_t> bends(const std::vector<BranchPoint>& points,
                                               std::size_t begin, std::size_t end,
                                               bool unknown) const {
    std::vector<std::size_t> ends;
    std::vector<std::size_t> open = {end};  // ends of unfinished parts, nearest last
    while (!open.empty()) {
      const std::span<const BranchPoint> piece(&points[begin], open.back() - begin + 1);
      const auto [farthest, away_m] = deviation(piece);
      const double spare_m = least_clearance(piece) - settings_.robot_radius_m;
      const double tolerance_m =
          unknown ? settings_.tolerance_m : std::min(settings_.tolerance_m, spare_m);
      if (away_m > tolerance_m) {
        open.push_back(begin + farthest);
      } else {
        begin = open.back();
        ends.push_back(begin);
        open.pop_back();
      }
    }
    return ends;
  }

  void add_place(const planning::Place& place, std::uint32_t index) {
    struct Access {
      double away_m;
      std::size_t piece;
      double t;
    };
    std::vector<Access> nearest;
    for (std::size_t i = 0; i < network_.pieces.size(); ++i) {
      const auto at =
          geometry::nearest_on_segment(end_of(i, true), end_of(i, false), place.position_m);
      nearest.push_back({distance(at.point_m, place.position_m), i, at.share});
    }
    std::ranges::stable_sort(nearest, {}, &Access::away_m);
    for (const Access& access : nearest) {
      const Eigen::Vector2d at =
          end_of(access.piece, true) +
          access.t * (end_of(access.piece, false) - end_of(access.piece, true));
      if (space_ != nullptr && !is_free(*space_, place.position_m, at)) continue;
      join(place, index, access.piece, access.t, at);
      return;
    }
    network_.notes.push_back(fmt::format(
        "place '{}': no free path on the grid to a branch, left without edges", place.name));
    add_node({place.position_m, 0.0, std::nullopt, index});
  }

  void join(const planning::Place& place, std::uint32_t index, std::size_t piece, double t,
            const Eigen::Vector2d& at_m) {
    // A centimetre is below the precision of any reader of these formats.
    constexpr double kSame_m = 0.01;
    const double length_m = distance(end_of(piece, true), end_of(piece, false));
    std::uint32_t access = 0;
    if (t * length_m < kSame_m) {
      access = network_.pieces[piece].from;
    } else if ((1.0 - t) * length_m < kSame_m) {
      access = network_.pieces[piece].to;
    } else {
      access = add_node({at_m, network_.pieces[piece].clearance_m, std::nullopt, std::nullopt});
      NetworkPiece rest = network_.pieces[piece];
      rest.from = access;
      network_.pieces[piece].to = access;
      network_.pieces.push_back(rest);
    }
    const double away_m = distance(place.position_m, network_.nodes[access].position_m);
    if (away_m < kSame_m && !network_.nodes[access].place) {
      network_.nodes[access].place = index;
      return;
    }
    const double clearance_m = clearance_at(place.position_m);
    const std::uint32_t node = add_node({place.position_m, clearance_m, std::nullopt, index});
    network_.pieces.push_back({access,
                               node,
                               std::min(clearance_m, network_.nodes[access].clearance_m),
                               std::nullopt,
                               {}});
  }

  [[nodiscard]] double clearance_at(const Eigen::Vector2d& position_m) const {
    if (space_ == nullptr) return settings_.robot_radius_m;
    const auto cell = space_->frame().cell_of(position_m);
    const double clearance_m = cell ? space_->clearance_m(*cell) : 0.0;
    return std::isfinite(clearance_m) ? clearance_m : settings_.robot_radius_m;
  }

  [[nodiscard]] const Eigen::Vector2d& end_of(std::size_t piece, bool from) const {
    const NetworkPiece& p = network_.pieces[piece];
    return network_.nodes[from ? p.from : p.to].position_m;
  }

  void add_notes() {
    if (virtual_ > 0) {
      network_.notes.push_back(
          fmt::format("{} virtual branches left out, no scan has seen them", virtual_));
    }
    if (joining_ > 0) {
      network_.notes.push_back(fmt::format(
          "{} virtual branches kept, only they join parts of the graph: no scan has seen them",
          joining_));
    }
    if (unknown_ > 0) {
      network_.notes.push_back(fmt::format(
          "{} branches have no known clearance, kept whatever the robot's radius", unknown_));
    }
    narrow_.erase(std::unique(narrow_.begin(), narrow_.end()), narrow_.end());
    if (!narrow_.empty()) {
      network_.notes.push_back(
          fmt::format("{} branches are narrower than the robot in places ({:g} m on each side), "
                      "left out there",
                      narrow_.size(), settings_.robot_radius_m));
    }
  }

  void keep_rules(std::span<const planning::DrawnZone> zones) {
    for (std::size_t i = 0; i < network_.pieces.size(); ++i) {
      network_.pieces[i].rule = rule_between(zones, end_of(i, true), end_of(i, false));
    }
    const auto forbidden = std::erase_if(
        network_.pieces, [](const NetworkPiece& piece) { return piece.rule.forbidden(); });
    if (forbidden > 0) {
      network_.notes.push_back(fmt::format("{} edges left out, zones forbid them", forbidden));
    }
  }

  /// Reports pieces that the grid forbids, and removes them if only free ones are wanted. Moving
  /// people in scans and unseen cells cause some of them.
  void check_on_grid() {
    if (space_ == nullptr) return;
    const std::size_t all = network_.pieces.size();
    const auto is_blocked = [&](const NetworkPiece& piece) {
      return !is_free(*space_, network_.nodes[piece.from].position_m,
                      network_.nodes[piece.to].position_m);
    };
    const auto blocked = std::ranges::count_if(network_.pieces, is_blocked);
    if (blocked == 0) return;
    if (settings_.only_free) std::erase_if(network_.pieces, is_blocked);
    network_.notes.push_back(fmt::format(
        "{} of {} edges pass obstacles or unknown cells within the forbidden distance of the "
        "grid{}",
        blocked, all, settings_.only_free ? ", left out" : ""));
  }

  const topomap::GlobalMap& map_;
  const planning::FreeSpace* space_;
  NetworkSettings settings_;
  RouteNetwork network_;
  std::map<std::uint32_t, std::uint32_t> node_of_;  // index by MapNode::id
  std::size_t virtual_ = 0;                         // virtual branches left out
  std::size_t joining_ = 0;                         // virtual branches that alone join parts
  std::size_t unknown_ = 0;                         // branches without clearance
  std::vector<std::uint32_t> narrow_;               // ids of branches
};

}  // namespace

std::set<std::uint32_t> joining_virtual_branches(const topomap::GlobalMap& map) {
  GraphParts parts(map.nodes);
  std::set<std::uint32_t> joining;
  for (const bool is_virtual : {false, true}) {
    for (const topomap::MapBranch& branch : map.branches) {
      if (branch.is_virtual == is_virtual && parts.join(branch) && is_virtual) {
        joining.insert(branch.id);
      }
    }
  }
  return joining;
}

RouteNetwork route_network(const topomap::GlobalMap& map, const storage::MapDrawing& drawing,
                           const planning::FreeSpace* space, const NetworkSettings& settings) {
  constexpr double kWidest_m = 100.0;  // no robot is wider
  support::check_range("radius of the robot", settings.robot_radius_m, 0.0, kWidest_m, "m");
  support::check_range("tolerance of edges", settings.tolerance_m, 0.0, 1.0, "m");
  return Builder(map, space, settings).build(drawing);
}

}  // namespace topogeo::exchange
