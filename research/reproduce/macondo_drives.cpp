#include "reproduce/macondo_drives.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "topogeo/devices/sonar_ring.hpp"
#include "topogeo/markov/markov_localizer.hpp"
#include "topogeo/markov/pose_localizer.hpp"
#include "topogeo/pipeline/world_grid.hpp"
#include "topogeo/planning/grid_sources.hpp"
#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/planning/motion_primitives.hpp"
#include "topogeo/simulation/sonar.hpp"

namespace topogeo::reproduce {

using geometry::Pose2;

namespace {

constexpr double kCell_m = 0.1;
constexpr double kSonarReach_m = 5.0;
constexpr double kExactReach_m = 2.5;
constexpr double kRounding_m = 1e-6;
constexpr double kLeastRoom_m = 0.15;  // half of the robot
constexpr double kFarError_m = 0.30;
constexpr double kFarErrorShare = 0.75;
constexpr int kLastLooks = 5;              // at the goal
constexpr double kLongestAdvance_m = 0.5;  // so that the robot looks around often enough
constexpr double kNodeReach_m = 0.15;      // of an expected position that is a node

markov::ObstacleCells obstacles_of(const planning::HybridMap& map) {
  const planning::GridFrame& frame = map.frame();
  std::vector<std::uint8_t> occupied;
  for (std::int32_t y = 0; y < frame.rows; ++y) {
    for (std::int32_t x = 0; x < frame.columns; ++x) {
      occupied.push_back(map.space().grid().at({x, y}) == planning::CellState::kOccupied ? 1 : 0);
    }
  }
  return markov::ObstacleCells({.width = frame.columns,
                                .height = frame.rows,
                                .resolution_m = frame.resolution_m,
                                .origin_m = frame.T_map_grid.position_m(),
                                .occupied = occupied});
}

/// The middle of a passable cell.
Eigen::Vector2d draw_place(const planning::HybridMap& map, support::Random& random) {
  for (;;) {
    const auto index =
        static_cast<std::size_t>(random.uniform() * static_cast<double>(map.frame().size()));
    const planning::Cell cell = map.frame().cell_at(std::min(index, map.frame().size() - 1));
    if (map.space().passable(cell)) return map.frame().center_m(cell);
  }
}

/// Executes primitives with the errors of the published transition matrices, which displace the
/// robot after each cell of an advance and after each turn. The heading is exact, as in the
/// publication.
class Wheels {
 public:
  /// `errors`: share of the errors that occur, [0, 1].
  Wheels(const world::World& scene, const Pose2& T_start, double errors, support::Random& random)
      : scene_(scene), T_(T_start), errors_(errors), random_(random) {}

  /// Returns the executed move: an advance ends before an obstacle.
  markov::Move execute(markov::Move move) {
    if (move.kind == markov::MoveKind::kAdvance) {
      const double sign = move.amount < 0.0 ? -1.0 : 1.0;
      double done_m = 0.0;
      while (std::fabs(move.amount) - done_m > kRounding_m) {
        const double step_m = std::min(kCell_m, std::fabs(move.amount) - done_m);
        const Pose2 T_next = T_ * Pose2{sign * step_m, 0.0, 0.0};
        if (world::clearance_m(scene_, T_next.position_m()) < kLeastRoom_m) break;
        T_ = T_next;
        done_m += step_m;
        if (step_m > 0.5 * kCell_m) displace(transition_.advance);
      }
      move.amount = sign * done_m;
    } else {
      const bool left = move.kind == markov::MoveKind::kTurnLeft;
      T_ = T_ * Pose2{0.0, 0.0, left ? move.amount : -move.amount};
      displace(left ? transition_.left : transition_.right);
    }
    hit_ |= world::clearance_m(scene_, T_.position_m()) < 0.5 * kCell_m;
    return move;
  }
  [[nodiscard]] const Pose2& pose() const { return T_; }
  [[nodiscard]] bool hit() const { return hit_; }

 private:
  void displace(const markov::TransitionMatrix& matrix) {
    if (errors_ < 1.0 && random_.uniform() >= errors_) return;
    double left =
        random_.uniform() * std::accumulate(matrix.values.begin(), matrix.values.end(), 0.0);
    std::size_t i = 0;
    while (i + 1 < matrix.values.size() && left >= matrix.values[i]) left -= matrix.values[i++];
    const int ahead = static_cast<int>(i) % matrix.columns - matrix.columns / 2;
    const int aside = matrix.rows / 2 - static_cast<int>(i) / matrix.columns;
    T_ = T_ * Pose2{kCell_m * ahead, kCell_m * aside, 0.0};
  }

  const world::World& scene_;
  Pose2 T_;
  double errors_;
  support::Random& random_;
  markov::TransitionModel transition_;
  bool hit_ = false;
};

markov::Move move_of(const planning::MotionPrimitive& primitive) {
  switch (primitive.kind) {
    case planning::MotionKind::kAdvance:
      return {markov::MoveKind::kAdvance, primitive.amount};
    case planning::MotionKind::kTurnLeft:
      return {markov::MoveKind::kTurnLeft, primitive.amount};
    case planning::MotionKind::kTurnRight:
      return {markov::MoveKind::kTurnRight, primitive.amount};
  }
  throw std::logic_error("unknown primitive");
}

/// The pose after an error-free move.
Pose2 after(const Pose2& T, const markov::Move& move) {
  switch (move.kind) {
    case markov::MoveKind::kAdvance:
      return T * Pose2{move.amount, 0.0, 0.0};
    case markov::MoveKind::kTurnLeft:
      return T * Pose2{0.0, 0.0, move.amount};
    case markov::MoveKind::kTurnRight:
      return T * Pose2{0.0, 0.0, -move.amount};
  }
  throw std::logic_error("unknown move");
}

/// Primitives as moves. The published rule needs a stop where the robot expects to be at a node of
/// the graph, the others one each half metre.
std::vector<markov::Move> moves_of(const std::vector<planning::MotionPrimitive>& primitives,
                                   const Pose2& T_start,
                                   const std::vector<Eigen::Vector2d>& nodes_m, bool at_nodes) {
  std::vector<markov::Move> moves;
  Pose2 T = T_start;
  for (const planning::MotionPrimitive& primitive : primitives) {
    const markov::Move move = move_of(primitive);
    if (move.kind != markov::MoveKind::kAdvance) {
      moves.push_back(move);
    } else {
      std::vector<double> stops_m;
      if (at_nodes) {
        for (const Eigen::Vector2d& node_m : nodes_m) {
          const Eigen::Vector2d in_robot = geometry::inverse(T) * node_m;
          const bool on_path = std::fabs(in_robot.y()) <= kNodeReach_m && in_robot.x() > 0.0 &&
                               in_robot.x() < move.amount;
          if (on_path) stops_m.push_back(in_robot.x());
        }
        std::ranges::sort(stops_m);
      } else {
        const int parts = std::max(1, static_cast<int>(std::ceil(move.amount / kLongestAdvance_m)));
        for (int i = 1; i < parts; ++i) stops_m.push_back(move.amount * i / parts);
      }
      stops_m.push_back(move.amount);
      double done_m = 0.0;
      for (const double stop_m : stops_m) {
        if (stop_m - done_m < kRounding_m) continue;
        moves.push_back({markov::MoveKind::kAdvance, stop_m - done_m});
        done_m = stop_m;
      }
    }
    T = after(T, move);
  }
  return moves;
}

struct Task {
  planning::HybridRoute route;
  Pose2 T_start;
  Eigen::Vector2d goal_m = Eigen::Vector2d::Zero();
};

Task draw_drive(const planning::HybridMap& map, support::Random& random) {
  const planning::HybridPlanner planner(map);
  for (;;) {
    const Eigen::Vector2d from_m = draw_place(map, random);
    const Eigen::Vector2d to_m = draw_place(map, random);
    planning::HybridRoute route = planner.plan(from_m, to_m);
    if (!route.found() || route.length_m < 3.0 || route.points_m.size() < 2) continue;
    const Eigen::Vector2d along = route.points_m[1] - route.points_m[0];
    return {route, {from_m.x(), from_m.y(), std::atan2(along.y(), along.x())}, to_m};
  }
}

/// Compares the sonar readings with the expected ones, and returns to the route when the robot has
/// left it. False when the robot is lost; `kept_off` becomes true when the path back is blocked.
bool relocalize(const world::World& scene, const Pose2& T_route, Wheels& wheels,
                markov::MarkovLocalizer& localizer, support::Random& random, bool& kept_off) {
  if (!localizer.perceive(published_readings(scene, wheels.pose(), random)).possible) return false;
  const auto back = localizer.relocalization_moves(T_route);
  if (!back) return false;
  kept_off |= back->blocked;
  if (back->blocked || back->moves.empty()) return true;
  localizer.accept_estimate();
  for (const markov::Move& move : back->moves) {
    if (!localizer.move(wheels.execute(move)).possible) return false;
  }
  return true;
}

}  // namespace

bool MacondoDrive::arrived() const {
  return localized && !hit && std::fabs(error_x_m) <= 1.5 * kCell_m &&
         std::fabs(error_y_m) <= 1.5 * kCell_m;
}

DrawnFloor draw_floor(const world::World& world) {
  DrawnFloor floor{world::scene_at(world, 0.0), nullptr};
  planning::FreeSpace space(planning::grid_of(pipeline::drawing_of(world), kCell_m));
  planning::ZoneMap zones = planning::zones_by_width(space);
  floor.map = std::make_shared<const planning::HybridMap>(std::move(space), std::move(zones));
  return floor;
}

std::vector<markov::RangeSensor> six_sonars() {
  std::vector<markov::RangeSensor> sensors;
  for (const devices::SonarMount& mount : devices::macondo_sonars()) {
    sensors.push_back({mount.T_robot_sonar, mount.half_cone_rad});
  }
  return sensors;
}

std::vector<float> published_readings(const world::World& scene, const Pose2& T_robot,
                                      support::Random& random) {
  std::vector<simulation::Echo> echoes;
  for (const devices::SonarMount& mount : devices::macondo_sonars()) {
    echoes.push_back(
        simulation::echo(scene, T_robot * mount.T_robot_sonar, mount.half_cone_rad, kSonarReach_m));
  }
  std::vector<float> readings = simulation::measure(echoes, {.range_max_m = kSonarReach_m}, random);
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const bool heard = echoes[i].range_m < kSonarReach_m;
    const bool far = heard && echoes[i].range_m > kExactReach_m + kRounding_m &&
                     random.uniform() < kFarErrorShare;
    if (far) readings[i] += static_cast<float>(random.uniform(-kFarError_m, kFarError_m));
  }
  return readings;
}

namespace {

/// The published localization, at the places that the rule names.
void drive_by_window(const DrawnFloor& floor, const Task& task, PerceptionRule rule, Wheels& wheels,
                     support::Random& random, MacondoDrive& drive) {
  std::vector<Eigen::Vector2d> nodes_m;
  for (const std::uint32_t node : task.route.nodes) {
    nodes_m.push_back(floor.map->nodes()[node].position_m);
  }
  const bool published = rule == PerceptionRule::kPublished;
  markov::MarkovLocalizer localizer({}, obstacles_of(*floor.map), six_sonars());
  drive.localized =
      rule == PerceptionRule::kNever ||
      localizer.initialize(task.T_start, published_readings(floor.world, wheels.pose(), random))
          .possible;
  Pose2 T_route = task.T_start;
  const auto at_node = [&] {
    return std::ranges::any_of(nodes_m, [&](const Eigen::Vector2d& node_m) {
      return (node_m - T_route.position_m()).norm() <= kNodeReach_m;
    });
  };
  const auto moves =
      moves_of(planning::motion_primitives(task.route.points_m, task.T_start.theta_rad),
               task.T_start, nodes_m, published);
  for (const markov::Move& move : moves) {
    if (!drive.localized) break;
    const markov::Move done = wheels.execute(move);
    T_route = after(T_route, move);
    if (rule != PerceptionRule::kNever) {
      drive.localized = localizer.move(done).possible;
      const bool perceives = !published || (move.kind == markov::MoveKind::kAdvance && at_node());
      if (drive.localized && perceives) {
        drive.localized =
            relocalize(floor.world, T_route, wheels, localizer, random, drive.kept_off);
      }
    }
    drive.truth.push_back(wheels.pose());
  }
  const int looks = rule == PerceptionRule::kNever ? 0 : published ? 1 : kLastLooks;
  for (int i = 0; drive.localized && i < looks; ++i) {
    drive.localized = relocalize(floor.world, T_route, wheels, localizer, random, drive.kept_off);
  }
}

/// The product's localization over poses; the robot goes back to its route after each move.
void drive_by_poses(const DrawnFloor& floor, const Task& task, Wheels& wheels,
                    support::Random& random, MacondoDrive& drive) {
  markov::PoseLocalizer localizer({}, obstacles_of(*floor.map), six_sonars(), kSonarReach_m,
                                  task.T_start);
  Pose2 T_route = task.T_start;
  const auto execute = [&](const markov::Move& move) {
    localizer.move(after({}, wheels.execute(move)));
    localizer.perceive(published_readings(floor.world, wheels.pose(), random));
    drive.truth.push_back(wheels.pose());
  };
  const auto return_to_route = [&] {
    const Pose2 T_robot = localizer.estimate().T_map_robot;
    const Eigen::Vector2d off_m = geometry::inverse(T_robot) * T_route.position_m();
    if (off_m.norm() < 0.5 * kCell_m) return;
    const double bearing_rad = std::atan2(off_m.y(), off_m.x());
    const auto turn = [&](double angle_rad) {
      if (std::fabs(angle_rad) < kRounding_m) return;
      execute({angle_rad > 0.0 ? markov::MoveKind::kTurnLeft : markov::MoveKind::kTurnRight,
               std::fabs(angle_rad)});
    };
    turn(bearing_rad);
    execute({markov::MoveKind::kAdvance, off_m.norm()});
    turn(geometry::wrap_angle(T_route.theta_rad - T_robot.theta_rad - bearing_rad));
  };
  for (const markov::Move& move :
       moves_of(planning::motion_primitives(task.route.points_m, task.T_start.theta_rad),
                task.T_start, {}, false)) {
    execute(move);
    T_route = after(T_route, move);
    return_to_route();
  }
  for (int i = 0; i < kLastLooks; ++i) return_to_route();
  drive.localized = localizer.located();
}

}  // namespace

MacondoDrive drive_macondo(const DrawnFloor& floor, std::uint64_t seed, const MacondoKind& kind) {
  support::Random random(seed);
  const Task task = draw_drive(*floor.map, random);
  MacondoDrive drive;
  drive.route_m = task.route.points_m;
  drive.goal = {task.goal_m.x(), task.goal_m.y(), 0.0};
  Wheels wheels(floor.world, task.T_start, kind.wheel_errors, random);
  drive.truth.push_back(wheels.pose());
  if (kind.rule == PerceptionRule::kPoses) {
    drive_by_poses(floor, task, wheels, random, drive);
  } else {
    drive_by_window(floor, task, kind.rule, wheels, random, drive);
  }
  drive.hit = wheels.hit();
  drive.error_x_m = wheels.pose().x_m - task.goal_m.x();
  drive.error_y_m = wheels.pose().y_m - task.goal_m.y();
  return drive;
}

}  // namespace topogeo::reproduce
