// A drive of a simulated robot to a place on a stored map, with all services (topogeo run --goto).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/trajectory.h"
#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/supervision/goto_phases.hpp"
#include "topogeo/topomap/trajectory.hpp"

#include "navigate/goal_session.hpp"
#include "run/ground_truth_log.hpp"
#include "run/service_run.hpp"

namespace topogeo::cli {

struct GotoResult {
  bool arrived = false;
  int signal_number = 0;  ///< signal that stopped the run, else 0
  std::string failure;    ///< why it did not arrive, unless a signal stopped it
  double drive_s = 0.0;   ///< from the goal to its end
  std::optional<navigation::NavigatorStatus> status;  ///< the last one
  std::optional<Eigen::Vector2d> goal_m;              ///< end of the route, map frame
  std::vector<topomap::StampedPose> estimated;  ///< poses while the robot was tracked, map frame
  std::vector<topomap::StampedPose> truth;      ///< the same; for the map's origin see run()
  std::uint64_t collisions = 0;
  std::uint64_t run_into = 0;
};

class GotoDrive {
 public:
  /// Starts the services, in a partition of their own. `options` has a goal, a simulation and a
  /// map. Throws like ServiceRun and GoalSession.
  explicit GotoDrive(const RunOptions& options);

  /// Returns when all services have ended. Call it once. The robot's first pose, at the start of
  /// the tour, is taken as the map's origin, where the mapping drive began, and for a robot without
  /// a laser as its base station.
  GotoResult run();

 private:
  void tick();
  void report_wait(const std::string& what);
  void call_off();
  void on_pose(const msg::LivePose& pose);
  /// First pose of the robot, see run().
  [[nodiscard]] geometry::Pose2 T_map_start();
  /// The condition still awaited; empty: the robot may set out.
  [[nodiscard]] std::string waits_for();

  RunOptions options_;
  GotoResult result_;
  supervision::GotoPhases phases_;
  std::string reported_;  // the condition last shown to the user
  std::optional<msg::LivePose> pose_;

  ServiceRun run_;
  GroundTruthLog truth_;
  messaging::Reader<msg::LivePose> poses_;
  GoalSession session_;
};

}  // namespace topogeo::cli
