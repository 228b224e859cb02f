// A base that is driven recklessly between obstacles: only a guard prevents collisions.
// Measurements reach the guard late, commands reach the base late, and everything may freeze.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <utility>

#include "topogeo/geometry/odometry_track.hpp"
#include "topogeo/geometry/velocity.hpp"
#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/simulation/simulated_robot.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::navigation {

/// Each message gets a random delay between the two; milliseconds.
struct DelayRange {
  std::uint64_t least_ms = 0;
  std::uint64_t most_ms = 0;
};

/// Hooks for the guard of the drive.
struct DriveGuard {
  std::function<void(const geometry::OdometrySample&)> add_odometry;
  std::function<void(const ScanPoints&)> add_scan;
  struct Answer {
    geometry::Velocity allowed;
    double free_m = 0.0;
  };
  std::function<Answer(const geometry::Velocity& wanted, std::int64_t now_ns)> judge;
  DelayRange sensors;   ///< from a measurement to the guard
  DelayRange commands;  ///< from its verdict until the base obeys
};

class ObstacleDrive {
 public:
  /// m/s^2, of the base.
  static constexpr double kBrake = 0.5;

  ObstacleDrive(std::uint64_t seed, DriveGuard guard);

  /// Passes 10 ms with everything running.
  void tick();
  /// Blocks measurements and commands until the base has run on for so long and stands still.
  void freeze(double runs_on_s);

  [[nodiscard]] std::uint64_t collisions() const { return robot_.collisions(); }
  [[nodiscard]] double path_m() const { return robot_.path_m(); }

 private:
  struct Measurement {
    std::int64_t arrival_ns;
    geometry::OdometrySample odometry;
    std::optional<ScanPoints> scan;
  };

  [[nodiscard]] geometry::Velocity reckless();
  void measure();
  [[nodiscard]] ScanPoints scan();
  void deliver();
  void command();
  void obey();
  void move();
  [[nodiscard]] std::int64_t late_ns(const DelayRange& range);

  support::Random random_;
  DriveGuard guard_;
  simulation::SimulatedRobot robot_;
  std::deque<Measurement> arriving_;
  std::deque<std::pair<std::int64_t, geometry::Velocity>> commands_;
  geometry::Velocity obeyed_;
  double free_m_;
  double turn_ = 0.0;
  int turn_commands_ = 0;  // number of commands for which it keeps turning
  std::int64_t now_ns_ = 1'000'000'000;
  std::int64_t ticks_ = 0;
};

}  // namespace topogeo::navigation
