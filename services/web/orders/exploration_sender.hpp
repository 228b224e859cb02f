// Starts autonomous exploration on an operator's order.
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
  /// `floor` returns the current floor and is called several times a second while exploring. If it
  /// throws std::invalid_argument, the previous floor stays.
  ExplorationSender(service::Service& service, GoalSender& goals, EventLog& events,
                    const RobotView& robot, std::function<ExploredFloor()> floor);
  ExplorationSender(const ExplorationSender&) = delete;
  ExplorationSender& operator=(const ExplorationSender&) = delete;
  ~ExplorationSender();

  /// Refused (409) for a robot that is not mapping or has no navigator.
  Answer start();
  /// The robot's current goal stays.
  void stop();
  /// Takes a navigator status; `end`: how the goal ended by it.
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
