// The whole system with a robot in a drawn world, in one process and on simulated time: sensor data
// goes through local maps, localizer, planner and navigator to the wheels, as it does through the
// services. The same arguments give the same drive to the last bit.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/geometry/velocity.hpp"
#include "topogeo/navigation/navigator.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/simulation/simulated_robot.hpp"
#include "topogeo/slam/slam.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::bench {

struct ClosedLoopConfig {
  pipeline::Config system;
  navigation::NavigatorConfig navigator;
  planning::HybridPlannerConfig planner;
  simulation::RobotOptions robot;
  /// Leaves out the pose's covariance, because it refers to the first stop and not to the map
  /// around the robot.
  bool mapping = false;
  double obeys_after_s = 0.15;  ///< delay from a command to the base's motion
};

/// Where to go: `target` as the planner takes it.
struct LoopGoal {
  navigation::GoalOrder order;
  planning::Target target;
  std::optional<double> heading_rad;  ///< map frame
};

class ClosedLoop {
 public:
  static constexpr std::int64_t kTick_ns = 10'000'000;

  /// The SLAM, for mapping or in a stored map, must outlive the loop. Throws like
  /// SimulatedRobot and Navigator.
  ClosedLoop(world::World world, const ClosedLoopConfig& config, localization::Slam& slam);

  void set_map(std::shared_ptr<const planning::HybridMap> map, std::uint64_t version);
  void set_goal(const LoopGoal& goal);

  /// Lets 10 ms pass.
  void tick();

  [[nodiscard]] double time_s() const { return 1e-9 * static_cast<double>(now_ns_); }
  [[nodiscard]] const simulation::SimulatedRobot& robot() const { return robot_; }
  [[nodiscard]] const navigation::Navigator& navigator() const { return navigator_; }
  /// The navigator's input; empty before the first stop.
  [[nodiscard]] const std::optional<navigation::PoseFix>& pose() const { return pose_; }
  /// Stops so far, including that of the last local map.
  [[nodiscard]] const std::vector<std::shared_ptr<const topomap::LocalMap>>& local_maps() const {
    return local_maps_;
  }
  /// True when the last tick made a stop that moved the poses of earlier ones, or the first one.
  [[nodiscard]] bool made_stop() const { return made_stop_; }
  /// Every plan made for the goal, including refusals.
  [[nodiscard]] const std::vector<navigation::RoutePlan>& plans() const { return plans_; }

 private:
  struct Command {
    std::int64_t from_ns = 0;
    geometry::Velocity velocity;
  };

  void scan();
  void sonar();
  void odometry();
  void locate();
  void plan_if_due();
  [[nodiscard]] navigation::RoutePlan plan() const;

  ClosedLoopConfig config_;
  simulation::SimulatedRobot robot_;
  localization::Slam& slam_;
  pipeline::LocalMapper mapper_;
  navigation::Navigator navigator_;
  std::int64_t now_ns_ = 0;
  std::uint64_t scans_ = 0;
  bool made_stop_ = false;
  std::vector<std::shared_ptr<const topomap::LocalMap>> local_maps_;
  std::optional<navigation::PoseFix> pose_;
  bool located_ = false;  // the pose is valid
  std::deque<Command> commands_;
  geometry::Velocity obeyed_;

  std::shared_ptr<const planning::HybridMap> map_;
  std::uint64_t map_version_ = 0;
  std::optional<planning::HybridPlanner> planner_;
  std::optional<LoopGoal> goal_;
  std::vector<navigation::RoutePlan> plans_;
};

}  // namespace topogeo::bench
