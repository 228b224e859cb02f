#include "obstacle_drive.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::navigation {
namespace {

constexpr std::int64_t kDriveTick_ns = 10'000'000;
constexpr double kFarAway_m = 5.0;

/// Columns and walls, far enough apart for the robot to pass between any two.
world::World hall_with_columns() {
  return world::parse_world(R"(
name: hall
walls:
  - {from: [0, 0], to: [9, 0]}
  - {from: [9, 0], to: [9, 7]}
  - {from: [9, 7], to: [0, 7]}
  - {from: [0, 7], to: [0, 0]}
  - {from: [4.5, 0], to: [4.5, 2.5]}
  - {from: [6.2, 4.4], to: [7.4, 4.4]}
columns:
  - {center: [2.2, 2.4], radius: 0.1}
  - {center: [2.6, 4.9], radius: 0.25}
  - {center: [4.6, 4.4], radius: 0.05}
  - {center: [7.0, 2.0], radius: 0.3}
tour: [[1, 1], [8, 6]]
)",
                            "hall");
}

simulation::RobotOptions base_options(std::uint64_t seed) {
  simulation::RobotOptions options;
  options.seed = seed;
  options.acceleration_m_per_s2 = ObstacleDrive::kBrake;
  options.angular_acceleration_rad_per_s2 = 1.0;
  options.T_world_start = geometry::Pose2{1.0, 1.0, 0.5};
  return options;
}

}  // namespace

ObstacleDrive::ObstacleDrive(std::uint64_t seed, DriveGuard guard)
    : random_(seed),
      guard_(std::move(guard)),
      robot_(hall_with_columns(), base_options(seed)),
      free_m_(kFarAway_m) {}

void ObstacleDrive::tick() {
  constexpr std::int64_t kMeasureTicks = 10;  // the base reports ten times a second
  constexpr std::int64_t kCommandTicks = 5;   // like the navigator
  if (ticks_ % kMeasureTicks == 0) measure();
  deliver();
  if (ticks_ % kCommandTicks == 0) command();
  obey();
  move();
}

void ObstacleDrive::freeze(double runs_on_s) {
  const std::int64_t expiry_ns = now_ns_ + static_cast<std::int64_t>(1e9 * runs_on_s);
  while (now_ns_ < expiry_ns) move();
  obeyed_ = {};
  const auto rolls = [this] { return robot_.velocity() != simulation::Velocity{}; };
  while (rolls()) move();
}

/// Full speed ahead; it turns away only when it is stuck, because the drive would end there.
geometry::Velocity ObstacleDrive::reckless() {
  constexpr double kNear_m = 0.1;
  if (turn_commands_-- <= 0) {
    turn_commands_ = 10 + static_cast<int>(random_.below(40));
    turn_ = random_.uniform(-0.9, 0.9);
  }
  if (free_m_ < kNear_m) return {0.0, turn_ < 0.0 ? -0.8 : 0.8};
  return {0.6, turn_};
}

void ObstacleDrive::measure() {
  Measurement measurement;
  measurement.arrival_ns = now_ns_ + late_ns(guard_.sensors);
  if (!arriving_.empty()) {
    measurement.arrival_ns = std::max(measurement.arrival_ns, arriving_.back().arrival_ns);
  }
  measurement.odometry = {now_ns_, robot_.T_odom_robot(), robot_.velocity().linear_m_per_s,
                          robot_.velocity().angular_rad_per_s};
  constexpr std::int64_t kScanTicks = 20;  // a PLS at 38400 baud
  if (ticks_ % kScanTicks == 0) measurement.scan = scan();
  arriving_.push_back(std::move(measurement));
}

ScanPoints ObstacleDrive::scan() {
  const simulation::BeamPattern& beams = robot_.options().beams;
  ScanPoints scan;
  scan.stamp_ns = now_ns_;
  scan.T_odom_robot = robot_.T_odom_robot();
  double angle_rad = beams.angle_min_rad;
  for (const float measured_m : robot_.scan()) {
    const auto range_m = static_cast<double>(measured_m);
    if (range_m > 0.0) {
      scan.points_m.emplace_back(range_m * std::cos(angle_rad), range_m * std::sin(angle_rad));
    }
    angle_rad += beams.angle_step_rad;
  }
  return scan;
}

void ObstacleDrive::deliver() {
  while (!arriving_.empty() && arriving_.front().arrival_ns <= now_ns_) {
    guard_.add_odometry(arriving_.front().odometry);
    if (arriving_.front().scan) guard_.add_scan(*arriving_.front().scan);
    arriving_.pop_front();
  }
}

void ObstacleDrive::command() {
  const DriveGuard::Answer answer = guard_.judge(reckless(), now_ns_);
  free_m_ = answer.free_m;
  std::int64_t due_ns = now_ns_ + late_ns(guard_.commands);
  if (!commands_.empty()) due_ns = std::max(due_ns, commands_.back().first);
  commands_.emplace_back(due_ns, answer.allowed);
}

void ObstacleDrive::obey() {
  while (!commands_.empty() && commands_.front().first <= now_ns_) {
    obeyed_ = commands_.front().second;
    commands_.pop_front();
  }
}

void ObstacleDrive::move() {
  robot_.step({obeyed_.linear_m_per_s, obeyed_.angular_rad_per_s},
              1e-9 * static_cast<double>(kDriveTick_ns));
  now_ns_ += kDriveTick_ns;
  ++ticks_;
}

std::int64_t ObstacleDrive::late_ns(const DelayRange& range) {
  return 1'000'000 *
         static_cast<std::int64_t>(range.least_ms + random_.below(range.most_ms - range.least_ms));
}

}  // namespace topogeo::navigation
