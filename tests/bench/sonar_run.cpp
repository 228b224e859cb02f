#include "sonar_run.hpp"

#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "topogeo/devices/sonar_ring.hpp"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/pipeline/world_grid.hpp"
#include "topogeo/planning/goal_planner.hpp"
#include "topogeo/simulation/simulated_robot.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/support/seed.hpp"

namespace topogeo::bench {
namespace {

using geometry::Pose2;

constexpr std::int64_t kSonarTick_ns = 10'000'000;

/// Robot, navigator and planner, without a laser and its localizer.
class SonarLoop {
 public:
  SonarLoop(const DrawnFloor& floor, const SonarDriveConfig& config, const SonarTask& task)
      : floor_(floor),
        config_(config.system),
        robot_(task.world, robot_options(config, task)),
        navigator_(config.system.navigator),
        goal_m_(task.T_map_goal.position_m()),
        heading_rad_(task.T_map_goal.theta_rad),
        T_map_station_(task.T_map_station) {
    navigator_.set_map(floor.map, 1);
    navigator_.set_goal({1, false});
  }

  void tick() {
    constexpr std::int64_t kControl_ns = 50'000'000;
    constexpr std::int64_t kOdometry_ns = 100'000'000;
    constexpr std::int64_t kSonar_ns = 200'000'000;
    constexpr std::int64_t kObeysAfter_ns = 150'000'000;
    while (!commands_.empty() && commands_.front().first <= now_ns_) {
      obeyed_ = commands_.front().second;
      commands_.pop_front();
    }
    robot_.step(obeyed_, 1e-9 * static_cast<double>(kSonarTick_ns));
    now_ns_ += kSonarTick_ns;
    if (now_ns_ % kOdometry_ns == 0) {
      navigator_.add(navigation::BaseCondition{now_ns_, true, {}});
      navigator_.add(navigation::OdometrySample{now_ns_, robot_.T_odom_robot()});
    }
    if (now_ns_ % kSonar_ns == 0) hear();
    if (now_ns_ % kControl_ns != 0) return;
    plan_if_due();
    commands_.emplace_back(now_ns_ + kObeysAfter_ns, navigator_.step(now_ns_));
  }

  [[nodiscard]] double time_s() const { return 1e-9 * static_cast<double>(now_ns_); }
  [[nodiscard]] const simulation::SimulatedRobot& robot() const { return robot_; }
  [[nodiscard]] const navigation::NavigatorStatus& status() const { return navigator_.status(); }
  [[nodiscard]] std::size_t plans() const { return plans_; }
  /// The last round, metres; scan::Scan::kNoReturn for none.
  [[nodiscard]] const std::vector<float>& ranges_m() const { return ranges_m_; }

 private:
  static simulation::RobotOptions robot_options(const SonarDriveConfig& config,
                                                const SonarTask& task) {
    simulation::RobotOptions robot =
        b21_robot(task.T_world_start, {}, config.wheels, config.slip_per_m, task.seed);
    robot.sonars = config.sonars == 6 ? devices::macondo_sonars() : devices::b21_sonars();
    robot.sonar = simulation::macondo_sonar_noise();
    return robot;
  }

  void hear() {
    navigation::SonarRound round;
    round.stamp_ns = now_ns_;
    ranges_m_ = robot_.sonar();
    for (std::size_t i = 0; i < ranges_m_.size(); ++i) {
      const devices::SonarMount& mount = robot_.options().sonars[i];
      round.readings.push_back({mount.T_robot_sonar, mount.half_cone_rad, ranges_m_[i]});
    }
    navigator_.add(round);
    if (!stands_at_station_) return;
    navigation::PoseFix station;
    station.stamp_ns = now_ns_;
    station.T_map_robot = T_map_station_;
    station.tracking = true;
    navigator_.add(station);
    stands_at_station_ = false;
  }

  void plan_if_due() {
    const auto& pose = navigator_.status().T_map_robot;
    if (!pose) return;
    const navigation::BlockageReport& blockages = navigator_.blockages();
    constexpr double kMoved_m = 0.1;  // after a refusal, as in the planner service
    const bool again = refused_at_m_ && (*refused_at_m_ - pose->position_m()).norm() >= kMoved_m;
    if (planned_for_ == blockages.version && !again) return;
    planned_for_ = blockages.version;
    refused_at_m_.reset();
    ++plans_;
    const planning::HybridRoute route =
        planning::plan_to_goal({floor_.map.get(), nullptr}, pose->position_m(), goal_m_,
                               blockages.points_m, {{}, config_.hybrid_planner, {}});
    navigation::RoutePlan plan;
    plan.goal_id = 1;
    plan.map_version = 1;
    plan.blockages_version = blockages.version;
    plan.found = route.found();
    plan.reason = route.reason;
    plan.points_m = route.points_m;
    plan.clearances_m = route.clearances_m;
    plan.parts = route.parts;
    plan.heading_rad = heading_rad_;
    for (const std::uint32_t node : route.nodes) {
      plan.nodes_m.push_back(floor_.map->nodes().at(node).position_m);
    }
    if (!plan.found) refused_at_m_ = pose->position_m();
    navigator_.set_route(plan);
  }

  const DrawnFloor& floor_;
  const pipeline::Config& config_;
  simulation::SimulatedRobot robot_;
  navigation::Navigator navigator_;
  Eigen::Vector2d goal_m_;
  double heading_rad_;
  Pose2 T_map_station_;
  bool stands_at_station_ = true;
  std::int64_t now_ns_ = 1'000'000'000;
  std::deque<std::pair<std::int64_t, geometry::Velocity>> commands_;
  geometry::Velocity obeyed_;
  std::optional<std::uint64_t> planned_for_;
  std::optional<Eigen::Vector2d> refused_at_m_;
  std::size_t plans_ = 0;
  std::vector<float> ranges_m_;
};

Pose2 draw_standing_pose(const DrawnFloor& floor, const SonarDriveConfig& config,
                         support::Random& random) {
  constexpr int kTries = 100'000;
  const planning::FreeSpace& space = floor.map->space();
  for (int i = 0; i < kTries; ++i) {
    const std::size_t index = random.below(space.frame().size());
    const planning::Cell cell = space.frame().cell_at(index);
    const double heading_rad = random.uniform(-std::numbers::pi, std::numbers::pi);
    if (!space.passable(index) || space.clearance_m(cell) < config.goal_clearance_m) continue;
    const Eigen::Vector2d point_m = space.frame().center_m(cell);
    return {point_m.x(), point_m.y(), heading_rad};
  }
  throw std::runtime_error(floor.name + ": no place for the robot");
}

/// Puts a box on the route where a robot can get past it.
bool put_box(const DrawnFloor& floor, const planning::HybridRoute& route, support::Random& random,
             SonarTask& task) {
  constexpr double kKeepsOff_m = 1.2;  // from station and goal
  constexpr double kPast_m = 0.75;     // from the middle of the box to its surroundings
  if (route.points_m.size() < 2) return false;
  const std::size_t piece = random.below(route.points_m.size() - 1);
  const double share = random.uniform();
  const Eigen::Vector2d at_m =
      (1.0 - share) * route.points_m[piece] + share * route.points_m[piece + 1];
  const double half_m = random.uniform(0.15, 0.25);
  if ((at_m - task.T_map_station.position_m()).norm() < kKeepsOff_m ||
      (at_m - task.T_map_goal.position_m()).norm() < kKeepsOff_m) {
    return false;
  }
  const auto cell = floor.map->frame().cell_of(at_m);
  if (!cell || floor.map->space().clearance_m(*cell) < half_m + kPast_m) return false;
  const std::vector<Eigen::Vector2d> corners{
      at_m + Eigen::Vector2d(-half_m, -half_m), at_m + Eigen::Vector2d(half_m, -half_m),
      at_m + Eigen::Vector2d(half_m, half_m), at_m + Eigen::Vector2d(-half_m, half_m)};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    task.world.segments.push_back({corners[i], corners[(i + 1) % corners.size()]});
  }
  task.obstacle = true;
  return true;
}

constexpr std::string_view kTraceHeader =
    "time_s,true_x_m,true_y_m,true_theta_rad,x_m,y_m,theta_rad,collisions,room_m,linear_m_per_s,"
    "angular_rad_per_s,ranges_m,state,reason,message\n";

/// `room_m`: from the body to the nearest object; `ranges_m`: in mounting order, 0 for none.
std::string trace_line(const SonarLoop& loop, const world::World& world) {
  const Pose2& truth = loop.robot().T_world_robot();
  const navigation::NavigatorStatus& status = loop.status();
  const Pose2 pose = status.T_map_robot.value_or(Pose2{});
  std::string ranges;
  for (const float range_m : loop.ranges_m()) ranges += fmt::format(" {:.2f}", range_m);
  return fmt::format(
      "{:.2f},{:.3f},{:.3f},{:.4f},{:.3f},{:.3f},{:.4f},{},{:.3f},{:.3f},{:.3f},{},{},{},\"{}\"\n",
      loop.time_s(), truth.x_m, truth.y_m, truth.theta_rad, pose.x_m, pose.y_m, pose.theta_rad,
      loop.robot().collisions(),
      world::clearance_m(world, truth.position_m()) - devices::kB21Radius_m,
      status.command.linear_m_per_s, status.command.angular_rad_per_s, ranges,
      navigation::describe(status.state), navigation::describe(status.reason), status.message);
}

SonarResult score_drive(const SonarLoop& loop, const SonarTask& task) {
  const navigation::NavigatorStatus& status = loop.status();
  const Pose2& truth = loop.robot().T_world_robot();
  const Eigen::Vector2d off_m = truth.position_m() - task.T_map_goal.position_m();
  SonarResult result;
  result.arrived = status.state == navigation::NavigatorState::kArrived;
  result.error_m = off_m.norm();
  result.error_x_m = std::fabs(off_m.x());
  result.error_y_m = std::fabs(off_m.y());
  result.heading_error_rad =
      std::fabs(geometry::wrap_angle(truth.theta_rad - task.T_map_goal.theta_rad));
  if (status.T_map_robot) {
    result.pose_error_m = (status.T_map_robot->position_m() - truth.position_m()).norm();
  }
  result.collisions = loop.robot().collisions();
  result.path_m = loop.robot().path_m();
  result.guard_stops = status.guard_stops;
  result.plans = loop.plans();
  result.end = std::string(navigation::describe(status.state)) + ", " +
               std::string(navigation::describe(status.reason)) + ": " + status.message;
  return result;
}

}  // namespace

DrawnFloor draw_floor(std::string_view name, const pipeline::HybridMapConfig& config) {
  DrawnFloor floor;
  floor.name = name;
  floor.world = name == "rooms"
                    ? world::load_world(TOPOGEO_SOURCE_DIR "/share/worlds/rooms.world.yaml")
                    : navigation_floor(name);
  storage::MapDrawing drawing;
  drawing.grid = planning::grid_of(pipeline::drawing_of(floor.world), config.grid.resolution_m);
  pipeline::HybridMapParts parts;
  parts.drawing = &drawing;
  floor.map = std::make_shared<const planning::HybridMap>(pipeline::make_hybrid_map(parts, config));
  return floor;
}

std::vector<std::string> drawn_floor_names() {
  std::vector<std::string> names{"rooms"};
  for (const std::string_view name : kNavigationFloors) names.emplace_back(name);
  return names;
}

SonarDriveConfig sonar_drive_config(const std::filesystem::path& settings) {
  SonarDriveConfig config;
  config.system = pipeline::load_config(
                      settings.empty() ? std::filesystem::path(TOPOGEO_SOURCE_DIR
                                                               "/deploy/sonar_robot.example.yaml")
                                       : settings)
                      .config;
  return config;
}

SonarTask draw_sonar_task(const DrawnFloor& floor, const SonarDriveConfig& config,
                          std::uint64_t seed) {
  constexpr int kTries = 1000;
  constexpr double kLeastRoute_m = 3.0;
  support::Random random(support::derive_seed(seed, "sonar drive", {}));
  const bool with_obstacle = random.uniform() < config.obstacle_share;
  const planning::HybridPlanner planner(*floor.map);
  for (int i = 0; i < kTries; ++i) {
    SonarTask task;
    task.seed = seed;
    task.world = floor.world;
    task.T_map_station = draw_standing_pose(floor, config, random);
    task.T_map_goal = draw_standing_pose(floor, config, random);
    task.T_world_start = task.T_map_station * Pose2{config.station_sigma_m * random.normal(),
                                                    config.station_sigma_m * random.normal(),
                                                    config.station_sigma_rad * random.normal()};
    if (world::clearance_m(floor.world, task.T_world_start.position_m()) <
        devices::kB21Radius_m + 0.03) {
      continue;
    }
    const planning::HybridRoute route =
        planner.plan(task.T_map_station.position_m(), task.T_map_goal.position_m());
    if (!route.found() || route.length_m < kLeastRoute_m) continue;
    task.route_length_m = route.length_m;
    if (with_obstacle && !put_box(floor, route, random, task)) continue;
    return task;
  }
  throw std::runtime_error(floor.name + ": no station and goal");
}

bool SonarResult::good() const {
  constexpr double kCell_m = 0.1;
  return arrived && error_x_m <= kCell_m && error_y_m <= kCell_m && collisions == 0;
}

SonarResult run_sonar_drive(const DrawnFloor& floor, const SonarDriveConfig& config,
                            const SonarTask& task, const std::filesystem::path& trace) {
  SonarLoop loop(floor, config, task);
  constexpr std::uint64_t kTraceTicks = 20;
  constexpr double kRolls_s = 1.0;  // until the wheels have stopped for certain
  const double start_s = loop.time_s();
  constexpr double kGivesUp_s = 60.0;  // standing for so long
  double arrived_s = -1.0;             // negative: not yet
  double largest_m = 0.0;
  double moved_s = start_s;
  double path_m = 0.0;
  std::string text(kTraceHeader);
  for (std::uint64_t ticks = 0; loop.time_s() - start_s < config.longest_s; ++ticks) {
    loop.tick();
    const navigation::NavigatorStatus& status = loop.status();
    if (status.T_map_robot) {
      largest_m = std::max(
          largest_m,
          (status.T_map_robot->position_m() - loop.robot().T_world_robot().position_m()).norm());
    }
    if (!trace.empty() && ticks % kTraceTicks == 0) text += trace_line(loop, task.world);
    if (loop.robot().path_m() > path_m + 0.05) {
      path_m = loop.robot().path_m();
      moved_s = loop.time_s();
    }
    if (loop.time_s() - moved_s > kGivesUp_s) break;
    if (status.state != navigation::NavigatorState::kArrived) {
      arrived_s = -1.0;
    } else if (arrived_s < 0.0) {
      arrived_s = loop.time_s();
    } else if (loop.time_s() - arrived_s > kRolls_s) {
      break;
    }
  }
  if (!trace.empty()) support::write_file_atomically(trace, text);
  SonarResult result = score_drive(loop, task);
  result.largest_pose_m = largest_m;
  result.time_s = (arrived_s < 0.0 ? loop.time_s() : arrived_s) - start_s;
  return result;
}

}  // namespace topogeo::bench
