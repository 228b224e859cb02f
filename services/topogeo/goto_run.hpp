// One run of all services on a simulated robot that is sent to a place of a stored map.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/msg/simulation.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/topomap/trajectory.hpp"

#include "goal_session.hpp"
#include "service_group.hpp"

namespace topogeo::cli {

struct GotoResult {
  bool arrived = false;
  int signal_number = 0;                       ///< that has stopped the run, else 0
  std::string failure;                         ///< why it did not arrive, when no signal did that
  double drive_s = 0.0;                        ///< from the goal to its end
  std::optional<msg::NavigatorStatus> status;  ///< the last one
  std::optional<Eigen::Vector2d> goal_m;       ///< end of the route, map frame
  std::vector<topomap::StampedPose> believed;  ///< poses while the robot was tracked, map frame
  std::vector<topomap::StampedPose> truth;     ///< the same; what the map's origin is, see run()
  std::uint64_t collisions = 0;
  std::uint64_t run_into = 0;
};

class GotoRun {
 public:
  /// Starts the services, in a partition of their own. `options` has a goal, a simulation and a
  /// map. Throws like messaging::Participant, ServiceGroup and GoalSession.
  explicit GotoRun(const RunOptions& options);

  /// Comes back when no service runs any more. Call it once. The map's origin is taken for where
  /// the robot stands at first, the start of the tour, where the drive began that made the map.
  GotoResult run();

 private:
  enum class Phase : std::uint8_t { kWaiting, kDriving, kCallingOff };

  GotoRun(const RunOptions& options, const std::string& partition);
  void tick();
  void check_deaths();
  void wait_for_start();
  void drive();
  void call_off();
  void on_signal(int number);
  void on_truth(const msg::GroundTruth& truth);
  void on_pose(const msg::LivePose& pose);
  void fail(const std::string& why);
  /// What there is still to wait for; empty: the robot may set out.
  [[nodiscard]] std::string waits_for();

  RunOptions options_;
  GotoResult result_;
  Phase phase_ = Phase::kWaiting;
  double since_s_;  // the phase began
  std::string told_;
  std::optional<msg::LivePose> pose_;
  std::optional<geometry::Pose2> T_world_map_;

  messaging::Participant participant_;
  messaging::Reader<msg::GroundTruth> truths_;
  messaging::Reader<msg::LivePose> poses_;
  messaging::EventLoop loop_;
  GoalSession session_;
  std::atomic<int> signal_ = 0;
  messaging::SignalStop signals_;
  ServiceGroup services_;  // after the readers: they must not miss what the services say
};

}  // namespace topogeo::cli
