// Drives a simulated robot along the tour of its world by motion commands, which go through gateway
// and base like those of a navigator. Without scans the robot stands still. The simulator reports
// the true poses.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/simulation/tour_follower.hpp"

#include "run/ground_truth_log.hpp"

namespace topogeo::cli {

class TourDriver {
 public:
  /// Lives in the loop. Throws like TourFollower.
  TourDriver(const messaging::Participant& participant, messaging::EventLoop& loop,
             std::string robot_id, const std::vector<Eigen::Vector2d>& tour_m,
             const simulation::DriveOptions& options);

  /// Starts the drive; the robot stands still before.
  void set_out() { started_ = true; }
  /// The robot stands at the end of the tour, and a scan from there has arrived.
  [[nodiscard]] bool arrived() const { return arrived_; }
  /// Completed share of the tour, [0, 1].
  [[nodiscard]] double share() const;
  /// Twenty times the duration of the tour at full speed has passed: the robot will not arrive any
  /// more.
  [[nodiscard]] bool overdue() const { return driven_s_ > limit_s_; }

  /// True poses of the robot.
  [[nodiscard]] const GroundTruthLog& truth() const { return truth_; }

 private:
  void on_truth(const msg::GroundTruth& truth, double step_s);
  void command(const simulation::Velocity& velocity);

  std::string robot_id_;
  simulation::TourFollower follower_;
  double tour_m_;
  double limit_s_;
  messaging::Writer<msg::MotionCommand> commands_;
  messaging::Reader<msg::Scan> scans_;
  bool started_ = false;
  bool arrived_ = false;
  bool at_end_ = false;
  double scan_came_s_ = 0.0;    // world time
  double command_due_s_ = 0.0;  // world time
  double driven_s_ = 0.0;
  double standing_s_ = 0.0;  // at the end
  std::uint64_t commands_sent_ = 0;
  GroundTruthLog truth_;
};

}  // namespace topogeo::cli
