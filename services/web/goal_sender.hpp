// Gives the robot its goals, one after the other: channel `goals`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/planning.h"
#include "topogeo/service/service.hpp"

#include "board.hpp"
#include "goal_list.hpp"
#include "map_view.hpp"
#include "order_text.hpp"

namespace topogeo::web {

class EventLog;

/// Lives in the loop of its service.
class GoalSender {
 public:
  GoalSender(service::Service& service, Board& board, const MapView& map, EventLog& events);

  /// Throws std::invalid_argument naming a place that the map does not have; then nothing has
  /// changed. The id of the first of these goals.
  std::uint64_t add(const GoalOrders& orders);
  void pause();
  void resume();
  void cancel();
  void take(const msg::NavigatorStatus& status);

  [[nodiscard]] std::size_t waiting() const { return list_.waiting().size(); }
  /// Where a goal is on the map of now.
  [[nodiscard]] Eigen::Vector2d position_of(const WantedGoal& goal) const;

 private:
  [[nodiscard]] Goal make(const WantedGoal& wanted);
  void send_current();
  void order(msg::GoalKind kind);
  void send(msg::Goal message);
  void show();

  service::Service& service_;
  Board& board_;
  const MapView& map_;
  EventLog& events_;
  std::string client_id_;
  GoalList list_;
  std::uint64_t sent_ = 0;
  messaging::Writer<msg::Goal> goals_;
};

}  // namespace topogeo::web
