#include "order_input.hpp"

#include <variant>

#include "topogeo/messaging/message.hpp"
#include "topogeo/support/log.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::ros_bridge {
OrderInput::OrderInput(RosSide& ros, const PoseOutput& pose)
    : ros_(ros),
      pose_(pose),
      client_id_("ros_bridge-" + std::to_string(support::unrepeatable_u64())),
      goals_(ros.service()),
      commands_(ros.service().advertise<msg::LocalizationCommand>()) {
  const Settings& settings = ros.settings();
  if (settings.directions.goal) {
    ros.subscribe<ros::PoseStamped>(settings.topics.goal, ros::Qos::kReliable,
                                    [this](const ros::PoseStamped& message,
                                           const messaging::SampleInfo&) { on_goal(message); });
    ros.service().subscribe<msg::NavigatorStatus>(
        [this](const msg::NavigatorStatus&, const messaging::SampleInfo& info) {
          goals_.note_navigator(info);
        });
  }
  if (settings.directions.initial_pose) {
    ros.subscribe<ros::PoseWithCovarianceStamped>(
        settings.topics.initial_pose, ros::Qos::kReliable,
        [this](const ros::PoseWithCovarianceStamped& message, const messaging::SampleInfo&) {
          on_initial_pose(message);
        });
    ros.service().subscribe<msg::LocalizationReply>([this](const msg::LocalizationReply& reply) {
      if (reply.client_id() != client_id_.c_str() || reply.accepted()) return;
      ros_.complain("initial pose refused", reply.message().to_string());
    });
  }
  for (const char* counter : {"goals", "initial_poses"}) {
    ros.service().status().set_counter(counter, 0.0);
  }
}

void OrderInput::on_goal(const ros::PoseStamped& message) {
  service::Goal goal =
      to_goal(message, ros_.settings().frames, pose_.T_map_odom(), pose_.T_map_robot());
  goal.goal_id = support::unrepeatable_u64() | 1U;
  goal.client_id = client_id_;
  service::Service& service = ros_.service();
  if (goals_.knows_navigator() && !goals_.has_navigator()) {
    ros_.complain("goal not driven", "the navigator is gone");
    return;
  }
  if (!goals_.send(service::to_msg(goal, service.robot_id(), ros_.now_ns(), sent_++))) return;
  if (!goals_.knows_navigator()) ros_.complain("goal not driven", "there is no navigator");
  const auto& target = std::get<Eigen::Vector2d>(goal.target);
  spdlog::info("goal {:.2f}, {:.2f}", target.x(), target.y());
  service.status().add_to_counter("goals");
}

void OrderInput::on_initial_pose(const ros::PoseWithCovarianceStamped& message) {
  service::LocalizationCommand command = to_set_pose(message, ros_.settings().frames.map);
  command.request_id = support::unrepeatable_u64();
  command.client_id = client_id_;
  service::Service& service = ros_.service();
  if (!service.send(commands_, service::to_msg(command, service.robot_id(), ros_.now_ns(), sent_++),
                    "initial pose")) {
    return;
  }
  service.status().add_to_counter("initial_poses");
}

}  // namespace topogeo::ros_bridge
