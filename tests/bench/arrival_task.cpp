// Drawing starts, goals and obstacles.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "topogeo/devices/sonar_ring.hpp"
#include "topogeo/planning/grid_search.hpp"
#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/support/seed.hpp"

#include "arrival_run.hpp"

namespace topogeo::bench {
namespace {

using geometry::Pose2;
using planning::Cell;

constexpr double kLeastWay_m = 3.0;
constexpr double kKeepOff_m = 1.0;  // between obstacles and start or goal
constexpr std::int32_t kDraws = 1000;

struct Obstacle {
  ObstacleKind kind = ObstacleKind::kNone;
  Eigen::Vector2d at_m = Eigen::Vector2d::Zero();  // map frame
  double half_m = 0.2;                             // half its side, or its radius

  /// Largest distance of its surface from its middle.
  [[nodiscard]] double radius_m() const {
    return kind == ObstacleKind::kBox ? half_m * std::numbers::sqrt2 : half_m;
  }
};

/// A pose where the robot fits in the map and in the world.
Pose2 draw_pose(const MappedFloor& floor, const ArrivalConfig& config, support::Random& random) {
  const planning::FreeSpace& space = floor.map->space();
  for (std::int32_t i = 0; i < kDraws * 100; ++i) {
    const std::size_t index = random.below(space.frame().size());
    const Cell cell = space.frame().cell_at(index);
    const double heading_rad = random.uniform(-std::numbers::pi, std::numbers::pi);
    if (!space.passable(index) || space.clearance_m(cell) < config.goal_clearance_m) continue;
    const Eigen::Vector2d point_m = space.frame().center_m(cell);
    const Eigen::Vector2d world_m = floor.T_world_map() * point_m;
    if (world::clearance_m(floor.world, world_m) < devices::kB21Radius_m + 0.03) continue;
    return {point_m.x(), point_m.y(), heading_rad};
  }
  throw std::runtime_error(floor.world.name + ": no place for the robot");
}

/// The point `along_m` along a polyline.
Eigen::Vector2d point_on(const std::vector<Eigen::Vector2d>& line_m, double along_m) {
  for (std::size_t i = 1; i < line_m.size(); ++i) {
    const double piece_m = (line_m[i] - line_m[i - 1]).norm();
    if (along_m <= piece_m) {
      return line_m[i - 1] + (line_m[i] - line_m[i - 1]) * (along_m / piece_m);
    }
    along_m -= piece_m;
  }
  return line_m.back();
}

/// Whether a robot that keeps half a metre from the obstacle's surface can reach the goal.
bool leaves_a_way(const MappedFloor& floor, const ArrivalTask& task, const Obstacle& obstacle) {
  constexpr double kPast_m = 0.5;
  const planning::FreeSpace& space = floor.map->space();
  planning::SearchWindow window(space, planning::whole(space.frame()));
  const auto cell = space.frame().cell_of(obstacle.at_m);
  const auto from = space.frame().cell_of(task.T_map_start.position_m());
  const auto to = space.frame().cell_of(task.T_map_goal.position_m());
  if (!cell || !from || !to) return false;
  window.close_disc(*cell, (obstacle.radius_m() + kPast_m) / space.frame().resolution_m);
  return planning::shortest_path(window, *from, *to).has_value();
}

/// A door on the route that can be shut; most routes have none.
std::optional<Obstacle> draw_shut_door(const MappedFloor& floor, const planning::HybridRoute& route,
                                       support::Random& random) {
  if (route.nodes.empty()) return std::nullopt;
  const planning::BorderNode& node =
      floor.map->nodes().at(route.nodes[random.below(route.nodes.size())]);
  constexpr double kDoor_m = 0.7;  // half a door
  if (node.clearance_m > kDoor_m) return std::nullopt;
  return Obstacle{ObstacleKind::kShutDoor, node.position_m, node.clearance_m};
}

Obstacle draw_thing(const std::vector<Eigen::Vector2d>& route_m, double length_m,
                    support::Random& random) {
  constexpr std::array kKinds{ObstacleKind::kBox, ObstacleKind::kColumn, ObstacleKind::kPerson};
  Obstacle obstacle{kKinds.at(random.below(kKinds.size())), {}, 0.0};
  obstacle.half_m = obstacle.kind == ObstacleKind::kPerson ? 0.2 : random.uniform(0.15, 0.3);
  const Eigen::Vector2d aside_m(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2));
  obstacle.at_m = point_on(route_m, random.uniform(0.0, length_m)) + aside_m;
  return obstacle;
}

double way_to(const std::vector<Eigen::Vector2d>& line_m, const Eigen::Vector2d& point_m) {
  double best_m = std::numeric_limits<double>::infinity();
  double best_path_m = 0.0;
  double path_m = 0.0;
  for (std::size_t i = 1; i < line_m.size(); ++i) {
    const Eigen::Vector2d piece = line_m[i] - line_m[i - 1];
    const double share =
        std::clamp((point_m - line_m[i - 1]).dot(piece) / piece.squaredNorm(), 0.0, 1.0);
    const double off_m = (line_m[i - 1] + share * piece - point_m).norm();
    if (off_m < best_m) {
      best_m = off_m;
      best_path_m = path_m + share * piece.norm();
    }
    path_m += piece.norm();
  }
  return best_path_m;
}

void put(const MappedFloor& floor, const Obstacle& obstacle, support::Random& random,
         ArrivalTask& task) {
  const Eigen::Vector2d at_m =
      floor.T_world_map_at(floor.T_world_map() * obstacle.at_m) * obstacle.at_m;
  task.obstacle = obstacle.kind;
  task.obstacle_m = at_m;
  task.appears = random.uniform() < 0.5;
  const double before_m = random.uniform(1.5, 3.0);
  world::ChangingPart part;
  const double from_m = way_to(task.route_m, obstacle.at_m) - before_m;
  part.present.push_back(
      {task.appears ? std::max(from_m, 0.0) : 0.0, std::numeric_limits<double>::infinity()});
  if (obstacle.kind == ObstacleKind::kBox) {
    const double h = obstacle.half_m;
    const std::array<Eigen::Vector2d, 4> corners{
        at_m + Eigen::Vector2d(-h, -h), at_m + Eigen::Vector2d(h, -h), at_m + Eigen::Vector2d(h, h),
        at_m + Eigen::Vector2d(-h, h)};
    for (std::size_t i = 0; i < corners.size(); ++i) {
      part.segments.push_back({corners.at(i), corners.at((i + 1) % corners.size())});
    }
  } else {
    part.circles.push_back({at_m, obstacle.half_m});
  }
  task.world.changing.push_back(std::move(part));
}

void draw_obstacle(const MappedFloor& floor, const planning::HybridRoute& route,
                   support::Random& random, ArrivalTask& task) {
  for (std::int32_t i = 0; i < kDraws; ++i) {
    std::optional<Obstacle> obstacle;
    if (i < 20 && random.uniform() < 0.3) obstacle = draw_shut_door(floor, route, random);
    if (!obstacle) obstacle = draw_thing(task.route_m, task.route_length_m, random);
    const double off_m = kKeepOff_m + obstacle->radius_m();
    if ((obstacle->at_m - task.T_map_start.position_m()).norm() < off_m ||
        (obstacle->at_m - task.T_map_goal.position_m()).norm() < off_m) {
      continue;
    }
    if (leaves_a_way(floor, task, *obstacle)) return put(floor, *obstacle, random, task);
  }
}

}  // namespace

const char* to_string(ObstacleKind kind) {
  constexpr std::array kNames{"none", "box", "column", "person", "shut door"};
  return kNames.at(static_cast<std::size_t>(kind));
}

ArrivalTask draw_task(const MappedFloor& floor, const ArrivalConfig& config, std::uint64_t seed) {
  support::Random random(support::derive_seed(seed, "arrival", {}));
  const bool with_obstacle = random.uniform() < config.obstacle_share;
  const planning::HybridPlanner planner(*floor.map);
  for (std::int32_t i = 0; i < kDraws; ++i) {
    ArrivalTask task;
    task.seed = seed;
    task.world = floor.world;
    task.T_map_start = draw_pose(floor, config, random);
    task.T_map_goal = draw_pose(floor, config, random);
    task.T_world_start = floor.T_world_map_at(floor.T_world_map() * task.T_map_start.position_m()) *
                         task.T_map_start;
    const planning::HybridRoute route =
        planner.plan(task.T_map_start.position_m(), task.T_map_goal.position_m());
    if (!route.found() || route.length_m < kLeastWay_m) continue;
    task.route_m = route.points_m;
    task.route_length_m = route.length_m;
    if (with_obstacle) draw_obstacle(floor, route, random, task);
    if (with_obstacle && task.obstacle == ObstacleKind::kNone) continue;
    return task;
  }
  throw std::runtime_error(floor.world.name + ": no start and goal");
}

}  // namespace topogeo::bench
