#include "virtual_links.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "components.hpp"
#include "spatial_index.hpp"

namespace topogeo::topomap {
namespace {

// Fixed: fine enough to follow a driven curve with few points.
constexpr double kStep_m = 0.2;
// A link is one message on the network with at most 2,048 points; a step takes up to two.
constexpr double kMostSteps = 900.0;

// A place on the map.
struct Place {
  Eigen::Vector2d position_m;
  std::uint32_t node = 0;  ///< index of a node of its part
};

// Index of the places of the map and their connections.
class Parts {
 public:
  explicit Parts(const GlobalMap& map) : components_(map.nodes.size()), count_(map.nodes.size()) {
    std::map<std::uint32_t, std::uint32_t> index;
    for (const MapNode& node : map.nodes) {
      index.emplace(node.id, static_cast<std::uint32_t>(index.size()));
    }
    std::vector<Entry> entries;
    for (const MapBranch& branch : map.branches) {
      const std::uint32_t a = index.at(branch.node_a);
      if (components_.join(a, index.at(branch.node_b))) --count_;
      for (const BranchPoint& p : branch.points) {
        entries.emplace_back(IndexPoint(p.position_m.x(), p.position_m.y()), a);
      }
    }
    if (count_ > 1) tree_ = Tree(entries);
  }

  /// 0 without nodes.
  [[nodiscard]] std::size_t count() const { return count_; }
  /// False if the two were connected before.
  bool join(const Place& a, const Place& b) { return components_.join(a.node, b.node); }
  [[nodiscard]] bool connected(const Place& a, const Place& b) {
    return components_.root(a.node) == components_.root(b.node);
  }

  /// The nearest place of the map, or of the part that contains `like`, within reach_m of a point.
  [[nodiscard]] std::optional<Place> near(const Eigen::Vector2d& point_m, double reach_m,
                                          const Place* like = nullptr) {
    using Box = boost::geometry::model::box<IndexPoint>;
    const Box box({point_m.x() - reach_m, point_m.y() - reach_m},
                  {point_m.x() + reach_m, point_m.y() + reach_m});
    std::optional<Place> best;
    for (auto it = tree_.qbegin(boost::geometry::index::intersects(box)); it != tree_.qend();
         ++it) {
      const Place place{{it->first.x(), it->first.y()}, it->second};
      const double distance_m = (place.position_m - point_m).norm();
      if (distance_m > reach_m || (like != nullptr && !connected(place, *like))) continue;
      if (!best || distance_m < (best->position_m - point_m).norm()) best = place;
    }
    return best;
  }

  /// The place where the stop touches the map.
  [[nodiscard]] std::optional<Place> touched_by(const VisitedStop& stop, double reach_m) {
    for (const Eigen::Vector2d& seen_m : stop.seen_m) {
      if (std::optional<Place> place = near(seen_m, reach_m)) return place;
    }
    return std::nullopt;
  }

 private:
  using IndexPoint = boost::geometry::model::d2::point_xy<double>;
  using Entry = std::pair<IndexPoint, std::uint32_t>;
  using Tree = boost::geometry::index::rtree<Entry, boost::geometry::index::quadratic<16>>;

  Components components_;
  std::size_t count_ = 0;
  Tree tree_;
};

// A stop and the place where it touches the map.
struct Touch {
  std::size_t stop = 0;  ///< index in DrivenPath::stops
  Place place;
};

// A point of the driven path, between two stops.
struct PathPoint {
  Eigen::Vector2d position_m;
  std::size_t stop_a = 0;
  std::size_t stop_b = 0;
};

class PathDrawing {
 public:
  PathDrawing(const Eigen::Vector2d& from_m, std::size_t stop, double step_m) : step_m_(step_m) {
    points_.push_back({from_m, stop, stop});
  }

  /// Continues straight to a place between two stops. Steps of less than half are left out, because
  /// scans of a robot that stands or turns add nothing.
  void line_to(const Eigen::Vector2d& to_m, std::size_t stop_a, std::size_t stop_b) {
    const Eigen::Vector2d from_m = points_.back().position_m;
    const double length_m = (to_m - from_m).norm();
    if (length_m < 0.5 * step_m_) return;
    const int steps = static_cast<int>(std::ceil(length_m / step_m_));
    for (int k = 1; k <= steps; ++k) {
      const double share = static_cast<double>(k) / steps;
      points_.push_back({from_m + share * (to_m - from_m), stop_a, stop_b});
    }
  }

  [[nodiscard]] std::vector<PathPoint> points() && { return std::move(points_); }

 private:
  double step_m_;
  std::vector<PathPoint> points_;
};

double length_m(const std::vector<VisitedStop>& stops, std::size_t first, std::size_t last) {
  double length_m = 0.0;
  Eigen::Vector2d here_m = stops[first].T_map_robot.position_m();
  const auto go_to = [&](const Eigen::Vector2d& to_m) {
    length_m += (to_m - here_m).norm();
    here_m = to_m;
  };
  for (std::size_t i = first + 1; i <= last; ++i) {
    for (const Eigen::Vector2d& at_m : stops[i].path_m) go_to(at_m);
    go_to(stops[i].T_map_robot.position_m());
  }
  return length_m;
}

// Path from the place touched by one stop to the place touched by the other.
std::vector<PathPoint> path_between(const std::vector<VisitedStop>& stops, const Touch& from,
                                    const Touch& to) {
  const double step_m = std::max(kStep_m, length_m(stops, from.stop, to.stop) / kMostSteps);
  PathDrawing path(from.place.position_m, from.stop, step_m);
  path.line_to(stops[from.stop].T_map_robot.position_m(), from.stop, from.stop);
  for (std::size_t i = from.stop + 1; i <= to.stop; ++i) {
    for (const Eigen::Vector2d& at_m : stops[i].path_m) path.line_to(at_m, i - 1, i);
    path.line_to(stops[i].T_map_robot.position_m(), i - 1, i);
  }
  path.line_to(to.place.position_m, to.stop, to.stop);
  return std::move(path).points();
}

struct Link {
  std::uint32_t map_id = 0;  ///< of the stop at its end
  Place from;
  Place to;
  std::vector<PathPoint> path;  ///< between the two
};

// Reduces the path to the stretch between the two parts: from the last point within reach of the
// first part to the first point within reach of the other.
void trim(Link& link, Parts& parts, double reach_m) {
  const Place first = link.from;
  const Place last = link.to;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < link.path.size(); ++i) {
    if (const auto place = parts.near(link.path[i].position_m, reach_m, &first)) {
      link.from = *place;
      begin = i;
    }
  }
  std::size_t end = link.path.size();
  for (std::size_t i = begin; i < end; ++i) {
    if (const auto place = parts.near(link.path[i].position_m, reach_m, &last)) {
      link.to = *place;
      end = i + 1;
    }
  }
  link.path.erase(link.path.begin() + static_cast<std::ptrdiff_t>(end), link.path.end());
  link.path.erase(link.path.begin(), link.path.begin() + static_cast<std::ptrdiff_t>(begin));
}

std::vector<Link> links_needed(const std::vector<VisitedStop>& stops, double reach_m,
                               const GlobalMap& map) {
  std::vector<Link> links;
  Parts parts(map);
  if (parts.count() < 2) return links;
  std::optional<Touch> last;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    if (!stops[i].follows) last.reset();
    const std::optional<Place> place = parts.touched_by(stops[i], reach_m);
    if (!place) continue;
    const Touch here{i, *place};
    if (last && !parts.connected(last->place, here.place)) {
      Link link{stops[i].map_id, last->place, here.place, path_between(stops, *last, here)};
      trim(link, parts, reach_m);
      parts.join(last->place, here.place);
      links.push_back(std::move(link));
    }
    last = here;
  }
  return links;
}

double clearance_m(const Eigen::Vector2d& at_m, const VisitedStop& a, const VisitedStop& b) {
  if (a.points.empty() || b.points.empty()) {
    return std::max(a.clearance_m(at_m), b.clearance_m(at_m));
  }
  return std::min(a.clearance_m(at_m), b.clearance_m(at_m));
}

std::vector<BranchPoint> points_of(const Link& link, const std::vector<VisitedStop>& stops,
                                   const MapNode& from, const MapNode& to) {
  std::vector<BranchPoint> points{{from.position_m, from.clearance_m}};
  for (const PathPoint& p : link.path) {
    // A point at a node would give a step of length 0.
    const double to_end_m =
        std::min((p.position_m - from.position_m).norm(), (p.position_m - to.position_m).norm());
    if (to_end_m < 0.5 * kStep_m) continue;
    points.push_back({p.position_m, clearance_m(p.position_m, stops[p.stop_a], stops[p.stop_b])});
  }
  points.push_back({to.position_m, to.clearance_m});
  return points;
}

// Keeps the elements sorted by id.
template <typename Element>
void insert(Element element, std::vector<Element>& elements) {
  const auto at = std::ranges::lower_bound(elements, element.id, {}, &Element::id);
  elements.insert(at, std::move(element));
}

const MapNode& node_of(const GlobalMap& map, std::uint32_t id) {
  return *std::ranges::lower_bound(map.nodes, id, {}, &MapNode::id);
}

// The node at the end of a link at `place_m`; creates it with `new_id` if none is near enough.
MapNode node_at(const Eigen::Vector2d& place_m, double near_m, std::uint32_t new_id,
                GlobalMap& map) {
  MapBranch* branch = nullptr;
  std::size_t point = 0;
  double best_sq = std::numeric_limits<double>::infinity();
  for (MapBranch& b : map.branches) {
    for (std::size_t k = 0; k < b.points.size(); ++k) {
      const double sq = (b.points[k].position_m - place_m).squaredNorm();
      if (sq >= best_sq) continue;
      best_sq = sq;
      branch = &b;
      point = k;
    }
  }
  const MapNode& a = node_of(map, branch->node_a);
  const MapNode& b = node_of(map, branch->node_b);
  const double to_a_m = (a.position_m - place_m).norm();
  const double to_b_m = (b.position_m - place_m).norm();
  const bool at_end = point == 0 || point + 1 == branch->points.size();
  if (at_end || std::min(to_a_m, to_b_m) < near_m) return to_a_m <= to_b_m ? a : b;

  const BranchPoint at = branch->points[point];
  MapNode node{new_id,         NodeKind::kVirtual,   at.position_m,
               at.clearance_m, branch->observations, branch->last_seen_ns};
  MapBranch first = *branch;
  MapBranch second = *branch;
  const auto cut = static_cast<std::ptrdiff_t>(point);
  first.points.resize(point + 1);
  first.node_b = node.id;
  second.points.erase(second.points.begin(), second.points.begin() + cut);
  second.node_a = node.id;
  if (second.points.size() > first.points.size()) std::swap(first, second);
  second.id = new_id;
  *branch = std::move(first);
  insert(std::move(second), map.branches);
  insert(node, map.nodes);
  return node;
}

}  // namespace

void add_virtual_links(const DrivenPath& path, const GlobalMapConfig& config, GlobalMap& map) {
  for (const Link& link : links_needed(path.stops(), config.node_merge_m, map)) {
    const std::uint32_t id = kFirstLinkId + 3 * link.map_id;
    const MapNode from = node_at(link.from.position_m, config.node_merge_m, id + 1, map);
    const MapNode to = node_at(link.to.position_m, config.node_merge_m, id + 2, map);
    MapBranch branch;
    branch.id = id;
    branch.node_a = from.id;
    branch.node_b = to.id;
    branch.is_virtual = true;
    branch.observations = 0;
    branch.points = points_of(link, path.stops(), from, to);
    insert(std::move(branch), map.branches);
  }
}

}  // namespace topogeo::topomap
