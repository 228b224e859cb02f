// One run of all services on a simulated robot that is sent to a place of a stored map.
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

#include "goal_session.hpp"
#include "ground_truth_log.hpp"
#include "service_run.hpp"

namespace topogeo::cli {

struct GotoResult {
  bool arrived = false;
  int signal_number = 0;  ///< that has stopped the run, else 0
  std::string failure;    ///< why it did not arrive, when no signal did that
  double drive_s = 0.0;   ///< from the goal to its end
  std::optional<navigation::NavigatorStatus> status;  ///< the last one
  std::optional<Eigen::Vector2d> goal_m;              ///< end of the route, map frame
  std::vector<topomap::StampedPose> estimated;  ///< poses while the robot was tracked, map frame
  std::vector<topomap::StampedPose> truth;      ///< the same; what the map's origin is, see run()
  std::uint64_t collisions = 0;
  std::uint64_t run_into = 0;
};

class GotoRun {
 public:
  /// Starts the services, in a partition of their own. `options` has a goal, a simulation and a
  /// map. Throws like ServiceRun and GoalSession.
  explicit GotoRun(const RunOptions& options);

  /// Comes back when no service runs any more. Call it once. The robot stands at the start of the
  /// tour at first: that is taken for the map's origin, where the drive began that made the map,
  /// and of a robot without a laser for its base station.
  GotoResult run();

 private:
  void tick();
  void report_wait(const std::string& what);
  void call_off();
  void on_pose(const msg::LivePose& pose);
  /// Where the robot stands at first, see run().
  [[nodiscard]] geometry::Pose2 T_map_start();
  /// What there is still to wait for; empty: the robot may set out.
  [[nodiscard]] std::string waits_for();

  RunOptions options_;
  GotoResult result_;
  supervision::GotoPhases phases_;
  std::string reported_;  // what it waits for, as the user was informed last
  std::optional<msg::LivePose> pose_;

  ServiceRun run_;
  GroundTruthLog truth_;
  messaging::Reader<msg::LivePose> poses_;
  GoalSession session_;
};

}  // namespace topogeo::cli
