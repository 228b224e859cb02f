// A robot on a simulated floor, driven by a Navigator, with a planner that answers at once.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/navigation/navigator.hpp"
#include "topogeo/planning/goal_planner.hpp"
#include "topogeo/simulation/simulated_robot.hpp"

namespace topogeo::navigation {

inline constexpr std::int64_t kStep_ns = 50'000'000;

/// The hybrid map of a world's permanent surfaces, with zones by width.
std::shared_ptr<const planning::HybridMap> map_of(
    const world::World& world, const std::vector<Eigen::Vector2d>& filled_m = {});

struct DriveSettings {
  geometry::Pose2 T_world_start;
  NavigatorConfig navigator;
  bool noise = false;  ///< of laser, sonars, odometry and pose fixes
  std::uint64_t seed = 1;
  int delay_steps = 3;  ///< until the base obeys
  bool map_comes = true;
  bool scans_whole = true;  ///< false: only their points, so that there is no local map
  /// The planner plans along its branches first, and on the grid when they have no route.
  std::shared_ptr<const topomap::GlobalMap> graph{};
  /// Cells that the map shows as occupied although they are free.
  std::vector<Eigen::Vector2d> noise_m{};
};

class TestDrive {
 public:
  TestDrive(world::World world, const DriveSettings& settings);

  /// One step of 50 ms: sensors, navigator, planner, base.
  void step();
  /// Steps until the condition holds; false when it does not within `longest_s`.
  bool run_until(const std::function<bool()>& condition, double longest_s);
  bool arrives(double longest_s);

  /// The map gets these zones, and no others.
  void draw(const std::vector<planning::DrawnZone>& zones);
  void go_to(const Eigen::Vector2d& goal_m, std::optional<double> heading_rad = {});

  [[nodiscard]] const NavigatorStatus& status() const { return navigator.status(); }
  [[nodiscard]] bool halted(HaltReason reason) const { return status().reason == reason; }
  [[nodiscard]] double off_m() const;
  [[nodiscard]] double time_s() const { return static_cast<double>(now_ns) * 1e-9; }

  world::World world;
  DriveSettings settings;
  simulation::SimulatedRobot robot;
  std::shared_ptr<const planning::HybridMap> map;
  std::uint64_t map_version = 1;
  Navigator navigator;
  std::int64_t now_ns = 1'000'000'000;
  geometry::Velocity command;

  // Faults.
  bool odometry_comes = true;
  bool scans_come = true;
  bool poses_come = true;
  bool sonars_come = true;
  bool sonars_hear = true;
  bool tracking = true;
  bool base_ready = true;
  bool base_obeys = true;
  bool planner_answers = true;
  double sigma_m = 0.02;
  std::optional<world::Circle> glass{};  ///< invisible to the laser

  std::uint64_t goal_id = 0;
  Eigen::Vector2d goal_m = Eigen::Vector2d::Zero();
  std::optional<double> heading_rad;
  bool look_around = false;
  double shortest_clearance_m = 1e9;  ///< least distance of the middle to a surface in any step

  void send_route();

 private:
  void send_sensors();

  std::vector<geometry::Velocity> delayed_;
  std::uint64_t answered_goal_ = 0;
  std::uint64_t answered_map_ = 0;
  std::uint64_t answered_blockages_ = 0;
  support::Random random_;
  planning::HybridRoute plan(const planning::HybridMap& floor) const;
  int steps_ = 0;
};

/// A room of 8 x 6 m with its lower left corner in the origin.
world::World room();
/// Two rooms of 5 x 6 m, side by side from the origin, with doors of 1 m at y = 1.5 and y = 4.5.
world::World two_doors();

}  // namespace topogeo::navigation
