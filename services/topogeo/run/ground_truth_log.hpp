// Records the true poses of a simulated robot from start to end.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/simulation.h"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::cli {

class GroundTruthLog {
 public:
  /// `step_s`: world time since the previous message; 0 for the first.
  using Handler = std::function<void(const msg::GroundTruth& truth, double step_s)>;

  /// Lives in the loop. `on_truth` (may be empty) is called for each message of the robot.
  GroundTruthLog(const messaging::Participant& participant, messaging::EventLoop& loop,
                 std::string robot_id, Handler on_truth = {});

  /// World frame, fifty times a second.
  [[nodiscard]] const std::vector<topomap::StampedPose>& poses() const { return poses_; }
  [[nodiscard]] const msg::GroundTruth& last() const { return last_; }

 private:
  void add(const msg::GroundTruth& truth);

  std::string robot_id_;
  Handler on_truth_;
  std::vector<topomap::StampedPose> poses_;
  msg::GroundTruth last_;
  messaging::Reader<msg::GroundTruth> truths_;
};

}  // namespace topogeo::cli
