#include "branch_detour.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "topogeo/geometry/segment.hpp"
#include "topogeo/planning/route_planner.hpp"
#include "topogeo/topomap/local_map_builder.hpp"
#include "topogeo/voronoi/local_voronoi.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kFarthest_m = 10.0;    // limit of a local map
constexpr double kBesideBody_m = 0.04;  // free on either side, as for all paths past obstacles

// A place on the route ahead of the robot.
struct RoutePlace {
  Eigen::Vector2d at_m = Eigen::Vector2d::Zero();
  double rest_m = 0.0;   // from there to the end of the route
  std::size_t next = 0;  // index of the next point of the route
};

// Evenly spaced places, starting with the one nearest to the robot.
std::vector<RoutePlace> places_ahead(std::span<const Eigen::Vector2d> route_m,
                                     const Eigen::Vector2d& robot_m) {
  constexpr double kStep_m = 0.1;
  std::vector<RoutePlace> places;
  for (std::size_t i = 0; i + 1 < route_m.size(); ++i) {
    const Eigen::Vector2d line_m = route_m[i + 1] - route_m[i];
    const int steps = std::max(1, static_cast<int>(std::ceil(line_m.norm() / kStep_m)));
    for (int k = 0; k < steps; ++k) {
      places.push_back({route_m[i] + static_cast<double>(k) / steps * line_m, 0.0, i + 1});
    }
  }
  places.push_back({route_m.back(), 0.0, route_m.size()});
  for (std::size_t i = places.size() - 1; i > 0; --i) {
    places[i - 1].rest_m = places[i].rest_m + (places[i].at_m - places[i - 1].at_m).norm();
  }
  const auto nearest = std::ranges::min_element(places, [&](const auto& a, const auto& b) {
    return (a.at_m - robot_m).norm() < (b.at_m - robot_m).norm();
  });
  places.erase(places.begin(), nearest);
  return places;
}

// Places behind the last one at which the body would touch an obstacle.
std::span<const RoutePlace> behind_obstacles(std::span<const RoutePlace> places,
                                             std::span<const Eigen::Vector2d> obstacles_m,
                                             double body_m) {
  std::size_t behind = 0;
  std::size_t end = 0;
  for (; end < places.size(); ++end) {
    if (places.front().rest_m - places[end].rest_m > kFarthest_m) break;
    const bool touches = std::ranges::any_of(obstacles_m, [&](const Eigen::Vector2d& obstacle_m) {
      return (places[end].at_m - obstacle_m).norm() < body_m;
    });
    if (touches) behind = end + 1;
  }
  return places.subspan(behind, end - behind);
}

// Points near by that a path must keep off: the obstacles, the whole scan, and the cells of no-go
// zones and drawn walls.
std::vector<Eigen::Vector2d> to_keep_off_m(const SeenScan& seen,
                                           std::span<const Eigen::Vector2d> obstacles_m,
                                           const planning::FreeSpace& floor) {
  std::vector<Eigen::Vector2d> points_m(obstacles_m.begin(), obstacles_m.end());
  for (const planning::Cell& cell : floor.rules().no_go()) {
    const Eigen::Vector2d middle_m = floor.frame().center_m(cell);
    if ((middle_m - seen.T_map_robot.position_m()).norm() < kFarthest_m) {
      points_m.push_back(middle_m);
    }
  }
  constexpr double kAll_m = 100.0;
  for (const topomap::ScanPoint& p : topomap::scan_points(*seen.scan, seen.T_robot_laser, kAll_m)) {
    points_m.push_back(seen.T_map_robot *
                       Eigen::Vector2d(static_cast<double>(p.x_m), static_cast<double>(p.y_m)));
  }
  return points_m;
}

// Searches the best place to leave a branch and the place to rejoin the route.
class DetourSearch {
 public:
  DetourSearch(const topomap::GlobalMap& graph, std::span<const Eigen::Vector2d> route_m,
               const Eigen::Vector2d& robot_m, std::vector<Eigen::Vector2d> seen_m, double body_m,
               const planning::FreeSpace& floor)
      : graph_(graph),
        route_m_(route_m),
        robot_m_(robot_m),
        seen_m_(std::move(seen_m)),
        body_m_(body_m),
        floor_(floor) {}

  std::optional<BranchDetour> run(std::span<const RoutePlace> candidates) {
    constexpr std::size_t kEvery = 6;  // points of a branch: about 0.3 m
    planning::PlanScene scene;
    scene.zones = floor_.rules().zones();
    scene.lines = floor_.rules().lines();
    for (const topomap::MapBranch& branch : graph_.branches) {
      for (std::size_t i = 0; i < branch.points.size(); i += kEvery) {
        const planning::PlanResult result =
            planning::plan(graph_, robot_m_, branch.points[i].position_m, {3.0, body_m_}, scene);
        if (result.found()) leave_at_end(result, candidates);
      }
      const planning::PlanResult result =
          planning::plan(graph_, robot_m_, branch.points.back().position_m, {3.0, body_m_}, scene);
      if (result.found()) leave_at_end(result, candidates);
    }
    return std::move(best_);
  }

 private:
  // Beyond the clearance of the branch nothing is proved: floor hidden by an obstacle is assumed
  // free until the next scan shows it.
  void leave_at_end(const planning::PlanResult& along, std::span<const RoutePlace> candidates) {
    constexpr double kUnproved = 3.0;  // cost of a metre there
    constexpr std::size_t kStep = 3;   // of the places: 0.3 m
    const planning::RoutePoint& end = along.route.points.back();
    const double before_m = kUnproved * along.start->distance_m + along.route.length_m;
    for (std::size_t i = 0; i < candidates.size(); i += kStep) {
      const RoutePlace& back = candidates[i];
      const double line_m = (back.at_m - end.position_m).norm();
      const double unproved_m = std::max(0.0, line_m - end.clearance_m);
      const double cost_m = before_m + line_m + (kUnproved - 1.0) * unproved_m + back.rest_m;
      if (cost_m >= best_m_ || !is_clear(end.position_m, back.at_m)) continue;
      best_m_ = cost_m;
      best_ = joined(along.route, back);
    }
  }

  [[nodiscard]] bool is_clear(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const {
    return obeys_rules(a_m, b_m) &&
           std::ranges::none_of(seen_m_, [&](const Eigen::Vector2d& point_m) {
             const auto place = geometry::nearest_on_segment(a_m, b_m, point_m);
             return (place.point_m - point_m).norm() < body_m_;
           });
  }

  // Obeys one-way zones.
  [[nodiscard]] bool obeys_rules(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const {
    const planning::GridFrame& frame = floor_.frame();
    if (!floor_.rules().guides() || a_m == b_m) return true;
    const Eigen::Vector2d direction = frame.in_cells(b_m) - frame.in_cells(a_m);
    const int steps = static_cast<int>(2.0 * direction.norm()) + 1;
    for (int k = 0; k <= steps; ++k) {
      const auto cell = frame.cell_of(a_m + static_cast<double>(k) / steps * (b_m - a_m));
      if (cell && !floor_.rules().allows(frame.index(*cell), direction)) return false;
    }
    return true;
  }

  // Joins the robot, the branches, and the rest of the route.
  [[nodiscard]] BranchDetour joined(const planning::Route& route, const RoutePlace& back) const {
    BranchDetour detour;
    detour.points_m.push_back(robot_m_);
    for (const planning::RoutePoint& p : route.points) detour.points_m.push_back(p.position_m);
    detour.points_m.push_back(back.at_m);
    const auto rest_m = route_m_.subspan(back.next);
    detour.points_m.insert(detour.points_m.end(), rest_m.begin(), rest_m.end());
    detour.is_virtual = std::ranges::any_of(route.parts, [](const planning::RoutePart& part) {
      return part.on == planning::PlannedOn::kVirtualBranch;
    });
    return detour;
  }

  const topomap::GlobalMap& graph_;
  std::span<const Eigen::Vector2d> route_m_;
  const Eigen::Vector2d& robot_m_;
  std::vector<Eigen::Vector2d> seen_m_;
  double body_m_;
  const planning::FreeSpace& floor_;
  std::optional<BranchDetour> best_;
  double best_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace

topomap::GlobalMap branches_of(const SeenScan& seen, const NavigatorConfig& config) {
  voronoi::VoronoiConfig diagram_config = config.voronoi;
  diagram_config.forward_rad = -seen.T_robot_laser.theta_rad;
  const voronoi::LocalVoronoiDiagram diagram =
      voronoi::LocalVoronoi(diagram_config).compute(*seen.scan);
  topomap::LocalMap local;
  topomap::build_local_map(diagram, *seen.scan, seen.T_robot_laser, config.local_map, local);
  topomap::GlobalMap graph;
  for (const topomap::LocalNode& node : local.nodes) {
    graph.nodes.push_back({node.id, node.kind, seen.T_map_robot * node.position_m, node.clearance_m,
                           1, seen.scan->stamp_ns});
  }
  for (const topomap::LocalBranch& branch : local.branches) {
    topomap::MapBranch& copy = graph.branches.emplace_back();
    copy.id = branch.id;
    copy.node_a = branch.node_a;
    copy.node_b = branch.node_b;
    copy.is_virtual = branch.is_virtual;
    for (const topomap::BranchPoint& p : branch.points) {
      copy.points.push_back({seen.T_map_robot * p.position_m, p.clearance_m});
    }
  }
  return graph;
}

std::optional<BranchDetour> detour_along_branches(const SeenScan& seen,
                                                  std::span<const Eigen::Vector2d> route_m,
                                                  const Eigen::Vector2d& robot_m,
                                                  std::span<const Eigen::Vector2d> obstacles_m,
                                                  const planning::FreeSpace& floor,
                                                  const NavigatorConfig& config) {
  const topomap::GlobalMap graph = branches_of(seen, config);
  if (graph.branches.empty() || route_m.empty()) return std::nullopt;
  const double body_m = config.guard.radius_m + kBesideBody_m;
  const std::vector<RoutePlace> ahead = places_ahead(route_m, robot_m);
  const std::vector<Eigen::Vector2d> seen_m = to_keep_off_m(seen, obstacles_m, floor);
  const std::span<const RoutePlace> candidates = behind_obstacles(ahead, seen_m, body_m);
  return DetourSearch(graph, route_m, robot_m, seen_m, body_m, floor).run(candidates);
}

}  // namespace topogeo::navigation
