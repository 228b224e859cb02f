// A gateway that freezes at any moment of a drive past obstacles: the base runs on with its last
// command until its watchdog expires. What the guard allows must leave room for that.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <utility>

#include <gtest/gtest.h>

#include "topogeo/geometry/reaction_times.hpp"
#include "topogeo/navigation/collision_guard.hpp"
#include "topogeo/simulation/simulated_robot.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::navigation {
namespace {

using support::Random;

constexpr std::int64_t kTick_ns = 10'000'000;

/// A hall with columns and boxes, nowhere two of them so near that the robot cannot pass.
world::World hall() {
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

/// Commands at full speed, and turns that change at random: only the guard keeps it off obstacles.
class RecklessDriver {
 public:
  explicit RecklessDriver(std::uint64_t seed) : random_(seed) {}

  geometry::Velocity next(double free_m) {
    if (ticks_-- <= 0) {
      ticks_ = 10 + static_cast<int>(random_.below(40));
      turn_ = random_.uniform(-0.9, 0.9);
    }
    constexpr double kNear_m =
        0.1;  // there it turns away, or the drive would end at the first wall
    if (free_m < kNear_m) return {0.0, turn_ < 0.0 ? -0.8 : 0.8};
    return {0.6, turn_};
  }

 private:
  Random random_;
  int ticks_ = 0;
  double turn_ = 0.0;
};

/// Sensors, guard and base with the delays that the guard has to count.
class GuardedDrive {
 public:
  GuardedDrive(std::uint64_t seed, const GuardConfig& config)
      : random_(seed), driver_(seed + 1), guard_(config), robot_(hall(), options(config, seed)) {}

  /// 10 ms with the gateway at work.
  void tick() {
    if (ticks_ % 10 == 0) measure();
    deliver();
    if (ticks_ % 5 == 0) command();
    while (!commands_.empty() && commands_.front().first <= now_ns_) {
      obeyed_ = commands_.front().second;
      commands_.pop_front();
    }
    move();
  }

  /// The gateway freezes: no measurement and no command passes until the base stands.
  void freeze() {
    const std::int64_t expiry_ns =
        now_ns_ + static_cast<std::int64_t>(1e9 * geometry::kBaseWatchdog_s);
    while (now_ns_ < expiry_ns) move();
    obeyed_ = {};
    while (robot_.velocity() != geometry::Velocity{}) move();
  }

  [[nodiscard]] std::uint64_t collisions() const { return robot_.collisions(); }
  [[nodiscard]] double path_m() const { return robot_.path_m(); }

 private:
  struct Measurement {
    std::int64_t arrival_ns;
    OdometrySample odometry;
    std::optional<ScanPoints> scan;
  };

  static simulation::RobotOptions options(const GuardConfig& config, std::uint64_t seed) {
    simulation::RobotOptions options;
    options.seed = seed;
    options.acceleration_m_per_s2 = config.deceleration_m_per_s2;
    options.angular_acceleration_rad_per_s2 = 1.0;
    options.T_world_start = geometry::Pose2{1.0, 1.0, 0.5};
    return options;
  }

  /// The base reports ten times a second, the laser sends half as often; both come late.
  void measure() {
    Measurement measurement;
    measurement.arrival_ns = now_ns_ + random_delay_ns(30, 110);
    measurement.odometry = {now_ns_, robot_.T_odom_robot()};
    if (ticks_ % 20 == 0) measurement.scan = scan();
    arriving_.push_back(std::move(measurement));
  }

  ScanPoints scan() {
    const simulation::BeamPattern& beams = robot_.options().beams;
    ScanPoints scan;
    scan.stamp_ns = now_ns_;
    scan.T_odom_robot = robot_.T_odom_robot();
    double angle_rad = beams.angle_min_rad;
    for (const float range_m : robot_.scan()) {
      const auto range = static_cast<double>(range_m);
      if (range > 0.0)
        scan.points_m.emplace_back(range * std::cos(angle_rad), range * std::sin(angle_rad));
      angle_rad += beams.angle_step_rad;
    }
    return scan;
  }

  void deliver() {
    while (!arriving_.empty() && arriving_.front().arrival_ns <= now_ns_) {
      guard_.add(arriving_.front().odometry);
      if (arriving_.front().scan) guard_.add(*arriving_.front().scan);
      arriving_.pop_front();
    }
  }

  void command() {
    const GuardVerdict verdict = guard_.judge(driver_.next(free_m_), now_ns_);
    free_m_ = verdict.free_m;
    // The next command comes 50 ms later: until then this one holds.
    const std::int64_t due_ns = now_ns_ + random_delay_ns(10, 150);
    commands_.emplace_back(commands_.empty() ? due_ns : std::max(due_ns, commands_.back().first),
                           verdict.allowed);
  }

  void move() {
    robot_.step({obeyed_.linear_m_per_s, obeyed_.angular_rad_per_s}, 1e-9 * kTick_ns);
    now_ns_ += kTick_ns;
    ++ticks_;
  }

  std::int64_t random_delay_ns(std::uint64_t least_ms, std::uint64_t most_ms) {
    return 1'000'000 * static_cast<std::int64_t>(least_ms + random_.below(most_ms - least_ms));
  }

  Random random_;
  RecklessDriver driver_;
  CollisionGuard guard_;
  simulation::SimulatedRobot robot_;
  std::deque<Measurement> arriving_;
  std::deque<std::pair<std::int64_t, geometry::Velocity>> commands_;
  geometry::Velocity obeyed_;
  double free_m_ = CollisionGuard::kFarthest_m;
  std::int64_t now_ns_ = 1'000'000'000;
  std::int64_t ticks_ = 0;
};

struct Outcome {
  std::uint64_t contacts = 0;
  double path_m = 0.0;
};

/// Drives with different obstacles and turns, each frozen at a moment of its own.
Outcome freeze_drives(int drives, const GuardConfig& config) {
  Outcome outcome;
  Random random(5);
  for (int drive = 0; drive < drives; ++drive) {
    GuardedDrive robot(static_cast<std::uint64_t>(100 + drive), config);
    const std::uint64_t ticks = 200 + random.below(2000);
    for (std::uint64_t i = 0; i < ticks; ++i) robot.tick();
    robot.freeze();
    outcome.contacts += robot.collisions();
    outcome.path_m += robot.path_m();
  }
  return outcome;
}

TEST(FrozenGateway, TheRobotStopsBeforeWhatItHasSeen) {
  const int drives = std::getenv("TOPOGEO_ALL_FAULTS") != nullptr ? 200 : 40;
  const Outcome outcome = freeze_drives(drives, {});
  EXPECT_EQ(outcome.contacts, 0U);
  EXPECT_GT(outcome.path_m, 2.0 * drives) << "it drives";
}

TEST(FrozenGateway, AGuardThatCountsNoWatchdogLetsItTouch) {
  GuardConfig config;
  config.runs_on_s = 0.0;
  EXPECT_GT(freeze_drives(40, config).contacts, 0U);
}

}  // namespace
}  // namespace topogeo::navigation
