// Sends the robot its goals, one after the other: channel `goals`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "topogeo/messaging/events.hpp"
#include "topogeo/msg/planning.h"
#include "topogeo/service/goal_outbox.hpp"
#include "topogeo/service/service.hpp"

#include "channels/map_view.hpp"
#include "orders/goal_list.hpp"
#include "orders/goal_rounds.hpp"
#include "orders/order_text.hpp"
#include "orders/unconfirmed_order.hpp"
#include "server/channel_hub.hpp"

namespace topogeo::web {

class EventLog;

/// Lives in the loop of its service.
class GoalSender {
 public:
  GoalSender(service::Service& service, ChannelHub& hub, const MapView& map, EventLog& events);

  /// Returns the id of the first of these goals. Ends a pause, unless they only wait. Throws
  /// std::invalid_argument naming an unknown place, or if no navigator was heard; nothing has
  /// changed then.
  std::uint64_t add(const GoalOrders& orders);
  /// Replaces all goals by one goal of an exploration; returns its id. Not while is_pausing(): it
  /// would undo the pause.
  std::uint64_t send_to(const geometry::Pose2& T_map_goal, const std::string& text);
  void pause();
  /// Ends a pause, or the time that the robot stays at a goal.
  void resume();
  void cancel();
  /// Cancels all goals, because the robot is stopped, and keeps them, or the exploration, until
  /// another order, so that resume_interrupted() can continue.
  void interrupt();
  [[nodiscard]] bool has_interrupted() const { return was_exploring_ || !interrupted_.empty(); }
  /// Whether an exploration was interrupted; resume_interrupted() has no goals then.
  [[nodiscard]] bool was_exploring() const { return was_exploring_; }
  /// Sends the goals again that interrupt() has kept. Throws std::invalid_argument if no navigator
  /// is connected.
  void resume_interrupted();
  /// How the current goal ended, if it did; the next one has then been sent. A pause holds it back
  /// until a resume. Sends again what the navigator has not received.
  std::optional<GoalList::End> take(const msg::NavigatorStatus& status,
                                    const messaging::SampleInfo& info);
  /// Whether goals come from an exploration. One that begins ends a pause, as a goal does.
  void set_exploring(bool exploring);
  /// Shows how far an exploration is: `visited` targets, `given_up` of them not reached. `ended`:
  /// nothing reachable is left.
  void show_exploration(std::size_t visited, std::size_t given_up, bool ended);

  /// Whether there is a goal that has not ended.
  [[nodiscard]] bool under_way() const { return list_.current().has_value(); }
  /// Whether a pause was ordered that the navigator does not show yet.
  [[nodiscard]] bool is_pausing() const { return unconfirmed_.is_pause(); }
  /// Whether a navigator gets what is sent now.
  [[nodiscard]] bool has_navigator() const { return goals_.has_navigator(); }
  [[nodiscard]] std::size_t waiting() const { return list_.waiting().size(); }
  /// Position of a goal on the current map.
  [[nodiscard]] Eigen::Vector2d position_of(const WantedGoal& goal) const;

 private:
  [[nodiscard]] Goal make(const WantedGoal& wanted);
  void send_current();
  /// The next round waits behind the last goal of this one, so that a pause holds it back, too.
  void begin_next_round();
  /// Whether the robot stays at its goal before it drives to the next one.
  [[nodiscard]] bool waits_at_goal(const msg::NavigatorStatus& status);
  void order(msg::GoalKind kind, std::uint64_t goal_id = 0);
  /// Orders a cancel or a pause, and repeats it until the navigator has carried it out.
  void insist(msg::GoalKind kind);
  void cancel_all();
  void forget_interrupted();
  void send(msg::Goal message);
  void show();

  service::Service& service_;
  ChannelHub& hub_;
  const MapView& map_;
  EventLog& events_;
  std::string client_id_;
  GoalList list_;
  GoalRounds rounds_;
  GoalWait wait_;
  UnconfirmedOrder unconfirmed_;
  bool exploring_ = false;
  std::deque<Goal> interrupted_;
  bool was_exploring_ = false;
  std::string exploration_ = "null";  // JSON: how far the last one is
  std::uint64_t sent_ = 0;
  service::GoalOutbox goals_;
};

}  // namespace topogeo::web
