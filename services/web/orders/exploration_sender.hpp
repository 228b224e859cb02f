// Lets the robot explore by itself on an operator's order.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "topogeo/msg/planning.h"
#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/service/service.hpp"

#include "channels/robot_view.hpp"
#include "orders/exploration.hpp"
#include "orders/goal_sender.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

/// Lives in the loop of its service.
class ExplorationSender {
 public:
  /// `floor`: as it is now, asked for several times a second while it explores. May throw
  /// std::invalid_argument: then the one before stays.
  ExplorationSender(service::Service& service, GoalSender& goals, EventLog& events,
                    const RobotView& robot, std::function<ExploredFloor()> floor);
  ExplorationSender(const ExplorationSender&) = delete;
  ExplorationSender& operator=(const ExplorationSender&) = delete;
  ~ExplorationSender();

  /// Refused (409) for a robot that does not map.
  Answer start();
  /// The goal that the robot has stays.
  void stop();
  /// What the navigator reports; `end`: how the goal has ended by it.
  void take(const msg::NavigatorStatus& status, std::optional<GoalList::End> end);

 private:
  void step();
  void end();

  service::Service& service_;
  GoalSender& goals_;
  EventLog& events_;
  const RobotView& robot_;
  std::function<ExploredFloor()> floor_;
  Exploration exploration_;
  ExploredFloor newest_;
  std::uint64_t goal_id_ = 0;
  navigation::NavigatorStatus navigator_;
  std::uint64_t timer_ = 0;
};

}  // namespace topogeo::web
