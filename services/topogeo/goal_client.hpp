// Gives a goal to a robot's planner and navigator and follows whether it is reached.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/status.h"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/live_hybrid_map.hpp"
#include "topogeo/supervision/goal_watch.hpp"
#include "topogeo/support/patience.hpp"

#include "service_table.hpp"

namespace topogeo::cli {

class GoalClient {
 public:
  /// Lives in the loop. Throws like Reader and Writer.
  GoalClient(const messaging::Participant& participant, messaging::EventLoop& loop,
             std::string robot_id);
  GoalClient(const GoalClient&) = delete;
  GoalClient& operator=(const GoalClient&) = delete;

  /// What of a planner and a navigator of the robot is not there; empty: both are.
  [[nodiscard]] std::string missing() const;

  /// "the robot's machine is too busy: the CPU is short for navigator" while it is; else empty.
  [[nodiscard]] std::string too_busy() const;

  /// Sends a goal with a number of its own, or an order about the goal that the robot has.
  /// `patience_s`: see supervision::GoalWatch. Throws std::runtime_error when it cannot be sent and
  /// std::invalid_argument for one that does not fit into a message.
  void send(service::Goal goal, double patience_s = 60.0);
  /// Orders the robot to stop and forget the goal sent; nothing when none was.
  void cancel();
  /// Waits until the readers have what was sent; false when the patience is over before.
  bool delivered(support::Patience& patience);

  /// Of the goal sent: nothing as long as it may still be reached.
  [[nodiscard]] std::optional<supervision::GoalEnd> end();
  /// The newest.
  [[nodiscard]] const std::optional<navigation::NavigatorStatus>& status() const { return status_; }
  /// The first that was found for the goal sent.
  [[nodiscard]] const std::optional<msg::Route>& route() const { return route_; }
  /// The newest whole map; null before.
  std::shared_ptr<const planning::HybridMap> map();
  /// Whether the robot does not drive and is not commanded to move; true before the first status.
  [[nodiscard]] bool stands() const;
  /// Whether the newest status is of the goal sent.
  [[nodiscard]] bool taken() const { return status_ && status_->goal_id == goal_id_; }

 private:
  void listen();
  void note_busy();
  void take_status(const msg::NavigatorStatus& status);
  [[nodiscard]] bool is_own(const auto& message) const {
    return message.robot_id() == robot_id_.c_str();
  }

  std::string robot_id_;
  std::string client_id_;
  std::uint64_t goal_id_ = 0;  // 0: none sent
  std::uint64_t sent_ = 0;
  std::optional<supervision::GoalWatch> watch_;
  std::optional<navigation::NavigatorStatus> status_;
  std::optional<msg::Route> route_;
  ServiceTable services_;

  messaging::EventLoop& loop_;
  messaging::Writer<msg::Goal> goals_;
  messaging::Reader<msg::ServiceStatus> service_statuses_;
  messaging::Reader<msg::NavigatorStatus> statuses_;
  messaging::Reader<msg::Route> routes_;
  service::LiveHybridMap live_map_;
};

/// What a picture shows of a route: where it goes and where it begins and ends. Its cells are not
/// in a message.
planning::HybridRoute route_to_draw(const msg::Route& route);

}  // namespace topogeo::cli
