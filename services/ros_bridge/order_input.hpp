// Takes orders that people give in RViz and Foxglove: goals and the robot's pose.
#pragma once

#include <cstdint>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/goal_outbox.hpp"

#include "orders.hpp"
#include "pose_output.hpp"
#include "ros_side.hpp"

namespace topogeo::ros_bridge {

/// Lives in the loop of its service.
class OrderInput {
 public:
  OrderInput(RosSide& ros, const PoseOutput& pose);

 private:
  void on_goal(const ros::PoseStamped& message);
  void on_initial_pose(const ros::PoseWithCovarianceStamped& message);

  RosSide& ros_;
  const PoseOutput& pose_;
  std::string client_id_;
  service::GoalOutbox goals_;
  messaging::Writer<msg::LocalizationCommand> commands_;
  std::uint64_t sent_ = 0;
};

}  // namespace topogeo::ros_bridge
