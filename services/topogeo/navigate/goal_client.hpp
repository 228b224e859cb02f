// Gives a goal to a robot's planner and navigator and reports whether it is reached.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
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

#include "common/service_table.hpp"

namespace topogeo::cli {

class GoalClient {
 public:
  /// Must be used in the loop only. Throws like Reader and Writer.
  GoalClient(const messaging::Participant& participant, messaging::EventLoop& loop,
             std::string robot_id);
  GoalClient(const GoalClient&) = delete;
  GoalClient& operator=(const GoalClient&) = delete;

  /// Names of the missing services among the robot's planner and navigator; empty if both are
  /// connected. A navigator takes no order from before it was connected.
  [[nodiscard]] std::string missing() const;

  /// "the robot's machine is too busy: the CPU is short for navigator" during that; else empty.
  [[nodiscard]] std::string too_busy() const;

  /// Sends a goal under a new number, or an order about the robot's current goal. `patience_s`: see
  /// supervision::GoalWatch. Throws std::runtime_error when it cannot be sent and
  /// std::invalid_argument when it does not fit into a message.
  void send(service::Goal goal, double patience_s = 60.0);
  /// Orders the robot to stop and drop the goal sent; does nothing when none was sent.
  void cancel();
  /// Waits until the readers have received everything; false when the patience ends first.
  bool delivered(support::Patience& patience);

  /// End of the goal sent; empty while it may still be reached.
  [[nodiscard]] std::optional<supervision::GoalEnd> end();
  /// Whether the navigator has the goal sent and has not ended it, by its newest status.
  [[nodiscard]] bool in_hand() const { return watch_ && watch_->in_hand(); }
  /// Whether a goal was sent.
  [[nodiscard]] bool has_sent() const { return goal_id_ != 0; }
  /// Number of the navigator's statuses so far.
  [[nodiscard]] std::uint64_t statuses() const { return statuses_received_; }
  /// Whether another program replaced or cancelled the goal sent.
  [[nodiscard]] bool was_taken_away() const { return watch_ && watch_->was_taken_away(); }
  [[nodiscard]] const std::optional<navigation::NavigatorStatus>& status() const { return status_; }
  /// The first route found for the goal sent.
  [[nodiscard]] const std::optional<msg::Route>& route() const { return route_; }
  /// The newest complete map; null until there is one.
  std::shared_ptr<const planning::HybridMap> map();
  /// Whether the robot stands still and has no command to move; true before the first status.
  [[nodiscard]] bool stands() const;
  /// Whether the newest status refers to the goal sent.
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
  std::uint64_t goal_id_ = 0;  // 0: no goal was sent
  std::uint64_t sent_ = 0;
  std::uint64_t statuses_received_ = 0;
  std::optional<supervision::GoalWatch> watch_;
  std::optional<navigation::NavigatorStatus> status_;
  std::optional<msg::Route> route_;
  ServiceTable services_;
  std::map<std::string, messaging::Handle> programs_;  // of these services, by their names

  messaging::EventLoop& loop_;
  messaging::Writer<msg::Goal> goals_;
  messaging::Reader<msg::ServiceStatus> service_statuses_;
  messaging::Reader<msg::NavigatorStatus> statuses_;
  messaging::Reader<msg::Route> routes_;
  service::LiveHybridMap live_map_;
};

/// The visible part of a route: its path with start and end. A message does not contain the cells.
planning::HybridRoute route_to_draw(const msg::Route& route);

}  // namespace topogeo::cli
