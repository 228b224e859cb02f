#include "test_drive.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "topogeo/planning/grid_sources.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::navigation {
namespace {

simulation::RobotOptions options_of(const DriveSettings& settings) {
  simulation::RobotOptions options;
  options.seed = settings.seed;
  options.T_world_start = settings.T_world_start;
  options.acceleration_m_per_s2 = 1.0;
  options.angular_acceleration_rad_per_s2 = 3.0;
  options.footprint = settings.navigator.guard.footprint;
  options.minimum_turning_radius_m = settings.navigator.guard.minimum_turning_radius_m;
  if (!settings.noise) {
    options.odometry = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    options.laser = {0.0, 0.0, 0.0, 0.0};
    options.sonar.sigma_m = 0.0;
  }
  return options;
}

planning::Drawing drawing_of(const world::World& world) {
  planning::Drawing drawing;
  for (const auto& segment : world.segments) drawing.lines.push_back({segment.a_m, segment.b_m});
  for (const auto& circle : world.circles) {
    drawing.discs.push_back({circle.center_m, circle.radius_m});
  }
  drawing.inside_m = {world.tour_m.front()};
  return drawing;
}

}  // namespace

std::shared_ptr<const planning::HybridMap> map_of(const world::World& world,
                                                  const std::vector<Eigen::Vector2d>& filled_m) {
  planning::OccupancyGrid grid = planning::grid_of(drawing_of(world));
  for (const Eigen::Vector2d& point_m : filled_m) {
    if (const auto cell = grid.frame().cell_of(point_m)) {
      grid.set(*cell, planning::CellState::kOccupied);
    }
  }
  planning::FreeSpace space(std::move(grid));
  planning::ZoneMap zones = planning::zones_by_width(space);
  return std::make_shared<planning::HybridMap>(std::move(space), std::move(zones));
}

TestDrive::TestDrive(world::World floor, const DriveSettings& drive)
    : world(std::move(floor)),
      settings(drive),
      robot(world, options_of(drive)),
      map(map_of(world, drive.noise_m)),
      navigator(drive.navigator),
      delayed_(static_cast<std::size_t>(drive.delay_steps)),
      random_(drive.seed) {
  if (settings.map_comes) navigator.set_map(map, map_version);
}

void TestDrive::draw(const std::vector<planning::DrawnZone>& zones) {
  planning::FreeSpace space(map->space().grid(), map->space().inflation(), zones);
  planning::ZoneMap parts = planning::zones_by_width(space);
  map = std::make_shared<const planning::HybridMap>(std::move(space), std::move(parts));
  navigator.set_map(map, ++map_version);
}

void TestDrive::go_to(const Eigen::Vector2d& to_m, std::optional<double> looking_rad) {
  goal_m = to_m;
  heading_rad = looking_rad;
  navigator.set_goal({++goal_id, look_around});
}

planning::HybridRoute TestDrive::plan(const planning::HybridMap& floor) const {
  const Eigen::Vector2d from_m = robot.T_world_robot().position_m();
  if (!settings.graph) return planning::HybridPlanner(floor).plan(from_m, goal_m);
  return planning::plan_to_goal({settings.map_comes ? &floor : nullptr, settings.graph.get()},
                                from_m, goal_m, navigator.blockages().points_m,
                                {{planning::PlanFirstOn::kGraph}, {}, {}});
}

void TestDrive::send_route() {
  const BlockageReport& blockages = navigator.blockages();
  const auto closed = map_of(world, blockages.points_m);
  const auto found = plan(blockages.points_m.empty() ? *map : *closed);
  RoutePlan route;
  route.goal_id = goal_id;
  route.map_version = settings.map_comes ? map_version : 0;
  route.blockages_version = blockages.version;
  route.found = found.found();
  route.reason = found.reason;
  route.points_m = found.points_m;
  route.clearances_m = found.clearances_m;
  route.parts = found.parts;
  route.heading_rad = heading_rad;
  for (const std::uint32_t node : found.nodes)
    route.nodes_m.push_back(map->nodes()[node].position_m);
  navigator.set_route(route);
  answered_goal_ = goal_id;
  answered_map_ = map_version;
  answered_blockages_ = blockages.version;
}

void TestDrive::send_sensors() {
  const auto& T_odom = robot.T_odom_robot();
  if (odometry_comes) navigator.add(OdometrySample{now_ns, T_odom});
  if (steps_ % 2 == 0 && scans_come) {
    const auto& beams = robot.options().beams;
    const std::vector<float> ranges_m = robot.scan();
    ScanPoints scan;
    scan.stamp_ns = now_ns;
    scan.T_odom_robot = T_odom;
    auto whole = std::make_shared<scan::Scan>();
    whole->stamp_ns = now_ns;
    whole->angle_min_rad = beams.angle_min_rad;
    whole->angle_step_rad = beams.angle_step_rad;
    whole->ranges_m = ranges_m;
    whole->T_odom_robot = T_odom;
    if (settings.scans_whole) scan.scan = whole;
    for (std::size_t i = 0; i < ranges_m.size(); ++i) {
      if (ranges_m[i] <= scan::Scan::kNoReturn) continue;
      const double angle_rad = beams.angle_min_rad + static_cast<double>(i) * beams.angle_step_rad;
      const auto range_m = static_cast<double>(ranges_m[i]);
      const Eigen::Vector2d point_m(range_m * std::cos(angle_rad), range_m * std::sin(angle_rad));
      constexpr double kOnIt_m = 0.06;
      if (glass &&
          (robot.T_world_robot() * point_m - glass->center_m).norm() < glass->radius_m + kOnIt_m) {
        continue;
      }
      scan.points_m.push_back(point_m);
    }
    navigator.add(scan);
  }
  if (steps_ % 4 == 0 && sonars_come) {
    const std::vector<float> ranges_m = robot.sonar();
    SonarRound round;
    round.stamp_ns = now_ns;
    for (std::size_t i = 0; i < ranges_m.size(); ++i) {
      const auto& mount = robot.options().sonars[i];
      round.readings.push_back({mount.T_robot_sonar, mount.half_cone_rad,
                                sonars_hear ? ranges_m[i] : scan::Scan::kNoReturn});
    }
    navigator.add(round);
  }
  if (steps_ % 4 == 0 && poses_come) {
    PoseFix fix;
    fix.stamp_ns = now_ns;
    fix.T_map_robot = robot.T_world_robot();
    if (settings.noise) {
      fix.T_map_robot.x_m += 0.01 * random_.normal();
      fix.T_map_robot.y_m += 0.01 * random_.normal();
      fix.T_map_robot.theta_rad += 0.004 * random_.normal();
    }
    fix.covariance = Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, 1e-4).asDiagonal();
    fix.tracking = tracking;
    fix.state_text = tracking ? "" : "searching";
    navigator.add(fix);
  }
  navigator.add(BaseCondition{now_ns, base_ready, base_ready ? "" : "emergency stop"});
}

void TestDrive::step() {
  send_sensors();
  const bool new_question = answered_goal_ != goal_id || answered_map_ != map_version ||
                            answered_blockages_ != navigator.blockages().version;
  if (goal_id != 0 && planner_answers && new_question) send_route();
  command = navigator.step(now_ns);
  delayed_.push_back(command);
  const geometry::Velocity obeyed = delayed_.front();
  delayed_.erase(delayed_.begin());
  const bool moves = base_obeys && base_ready;
  robot.step(moves ? simulation::Velocity{obeyed.linear_m_per_s, obeyed.angular_rad_per_s}
                   : simulation::Velocity{},
             static_cast<double>(kStep_ns) * 1e-9);
  shortest_clearance_m = std::min(
      shortest_clearance_m, world::clearance_m(robot.scene(), robot.T_world_robot().position_m()));
  now_ns += kStep_ns;
  ++steps_;
}

bool TestDrive::run_until(const std::function<bool()>& condition, double longest_s) {
  const std::int64_t end_ns = now_ns + static_cast<std::int64_t>(longest_s * 1e9);
  while (now_ns < end_ns) {
    step();
    if (condition()) return true;
  }
  return false;
}

bool TestDrive::arrives(double longest_s) {
  return run_until([&] { return status().state == NavigatorState::kArrived; }, longest_s);
}

double TestDrive::off_m() const {
  return (robot.T_world_robot().position_m() - goal_m).norm();
}

world::World room() {
  return world::parse_world(R"(
name: room
walls:
  - {from: [0, 0], to: [8, 0]}
  - {from: [8, 0], to: [8, 6]}
  - {from: [8, 6], to: [0, 6]}
  - {from: [0, 6], to: [0, 0]}
tour: [[1, 1], [7, 5]]
)",
                            "room");
}

world::World two_doors() {
  return world::parse_world(R"(
name: two doors
walls:
  - {from: [0, 0], to: [10, 0]}
  - {from: [10, 0], to: [10, 6]}
  - {from: [10, 6], to: [0, 6]}
  - {from: [0, 6], to: [0, 0]}
  - {from: [5, 0], to: [5, 6], doors: [{at: 1.5, width: 1.0}, {at: 4.5, width: 1.0}]}
tour: [[1, 1], [9, 1]]
)",
                            "two doors");
}

}  // namespace topogeo::navigation
