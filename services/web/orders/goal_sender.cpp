#include "orders/goal_sender.hpp"

#include <random>
#include <stdexcept>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"

#include "channels/event_log.hpp"
#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

/// Unique among all clients, and never 0.
std::uint64_t random_goal_id() {
  std::random_device random;
  return (std::uint64_t{random()} << 16U) + (random() & 0xFFFFU) + 1;
}

Json goal_json(const Goal& goal) {
  Json json = {{"goal_id", std::to_string(goal.id)}, {"text", goal.text}};
  if (goal.message.kind() == msg::kGoalPosition) {
    json["x_m"] = rounded(goal.message.target().x_m());
    json["y_m"] = rounded(goal.message.target().y_m());
  }
  if (goal.wait_s > 0.0) json["wait_s"] = rounded(goal.wait_s);
  return json;
}

/// The navigator does not take an id twice.
void renumber(std::deque<Goal>& goals) {
  for (Goal& goal : goals) {
    goal.id = random_goal_id();
    goal.message.goal_id(goal.id);
  }
}

}  // namespace

GoalSender::GoalSender(service::Service& service, ChannelHub& hub, const MapView& map,
                       EventLog& events)
    : service_(service),
      hub_(hub),
      map_(map),
      events_(events),
      client_id_(support::process_name()),
      goals_(service) {
  show();
}

Eigen::Vector2d GoalSender::position_of(const WantedGoal& goal) const {
  if (goal.point_m) return *goal.point_m;
  const auto found = map_.find(goal.name);
  if (!found) throw std::invalid_argument("the map has no place or room '" + goal.name + "'");
  return found->position_m;
}

Goal GoalSender::make(const WantedGoal& wanted) {
  service::Goal order;
  order.goal_id = random_goal_id();
  order.client_id = client_id_;
  order.heading_rad = wanted.heading_rad;
  const Eigen::Vector2d position_m = position_of(wanted);
  order.kind = msg::kGoalPosition;
  order.target = position_m;
  const auto named = wanted.name.empty() ? std::nullopt : map_.find(wanted.name);
  if (named && named->place) {
    order.kind = msg::kGoalPlace;
    order.target = named->name;
  }
  Goal goal;
  goal.id = order.goal_id;
  goal.text = named ? named->name : describe(wanted);
  goal.message = service::to_msg(order, service_.robot_id(), 0, 0);
  goal.wait_s = wanted.wait_s;
  return goal;
}

std::uint64_t GoalSender::add(const GoalOrders& orders) {
  std::deque<Goal> goals;
  for (const WantedGoal& wanted : orders.goals) goals.push_back(make(wanted));
  if (!goals_.has_navigator()) throw std::invalid_argument("no navigator is connected");
  const std::uint64_t first = goals.front().id;
  forget_interrupted();
  exploration_ = "null";
  if (!orders.append) rounds_.begin(goals, orders.rounds);
  if (list_.add(std::move(goals), orders.append)) {
    unconfirmed_.end();
    send_current();
  }
  begin_next_round();
  show();
  return first;
}

std::uint64_t GoalSender::send_to(const geometry::Pose2& T_map_goal, const std::string& text) {
  WantedGoal wanted;
  wanted.point_m = T_map_goal.position_m();
  wanted.heading_rad = T_map_goal.theta_rad;
  Goal goal = make(wanted);
  goal.text = text;
  const std::uint64_t id = goal.id;
  std::deque<Goal> goals;
  goals.push_back(std::move(goal));
  if (list_.add(std::move(goals), false)) send_current();
  show();
  return id;
}

void GoalSender::set_exploring(bool exploring) {
  if (exploring && is_pausing()) unconfirmed_.end();
  if (exploring) {
    forget_interrupted();
    rounds_.end();
    exploration_ = "null";
  }
  exploring_ = exploring;
  show();
}

void GoalSender::show_exploration(std::size_t visited, std::size_t given_up, bool ended) {
  std::string now = text_of(Json{{"visited", visited}, {"given_up", given_up}, {"ended", ended}});
  if (now == exploration_) return;
  exploration_ = std::move(now);
  show();
}

void GoalSender::send_current() {
  const Goal& goal = *list_.current();
  events_.add(EventLog::Level::kInfo, "web", "goal: " + goal.text);
  send(goal.message);
}

void GoalSender::begin_next_round() {
  if (!list_.current() || !list_.waiting().empty()) return;
  std::deque<Goal> goals = rounds_.next();
  renumber(goals);
  list_.add(std::move(goals), true);
}

void GoalSender::order(msg::GoalKind kind, std::uint64_t goal_id) {
  service::Goal order;
  order.client_id = client_id_;
  order.kind = kind;
  order.goal_id = goal_id;
  send(service::to_msg(order, service_.robot_id(), 0, 0));
}

void GoalSender::send(msg::Goal message) {
  messaging::set_header(message, service_.robot_id(), support::wall_clock_ns(), sent_++);
  static_cast<void>(goals_.send(message));
}

void GoalSender::insist(msg::GoalKind kind) {
  unconfirmed_.begin(kind, list_.current() ? list_.current()->id : 0);
  order(kind);  // it names no goal, so that it stops the robot even if the goal changes meanwhile
}

void GoalSender::pause() {
  insist(msg::kGoalPause);
  show();
}

void GoalSender::resume() {
  unconfirmed_.end();
  wait_.skip();
  order(msg::kGoalResume);
  show();
}

void GoalSender::cancel() {
  forget_interrupted();
  rounds_.end();
  exploration_ = "null";
  cancel_all();
}

void GoalSender::cancel_all() {
  insist(msg::kGoalCancel);
  list_.clear();
  show();
}

// A second stop keeps what the first one has interrupted.
void GoalSender::interrupt() {
  if (exploring_ || list_.current()) {
    forget_interrupted();
    was_exploring_ = exploring_;
    if (!exploring_) {
      interrupted_ = list_.waiting();
      interrupted_.push_front(*list_.current());
    }
  }
  cancel_all();
}

void GoalSender::forget_interrupted() {
  interrupted_.clear();
  was_exploring_ = false;
}

void GoalSender::resume_interrupted() {
  if (!goals_.has_navigator()) throw std::invalid_argument("no navigator is connected");
  std::deque<Goal> goals = std::exchange(interrupted_, {});
  renumber(goals);
  if (list_.add(std::move(goals), false)) {
    unconfirmed_.end();
    send_current();
  }
  begin_next_round();
  show();
}

bool GoalSender::waits_at_goal(const msg::NavigatorStatus& status) {
  const auto& goal = list_.current();
  const bool arrived = goal && status.goal_id() == goal->id &&
                       status.state() == msg::kNavigatorArrived && !list_.waiting().empty();
  if (!arrived) return false;
  const bool begins = wait_.goal() != goal->id;
  if (!wait_.holds(*goal, support::monotonic_ns())) return false;
  if (begins) {
    events_.add(EventLog::Level::kInfo, "web",
                fmt::format("waits {:.0f} s at {}", goal->wait_s, goal->text));
    show();
  }
  return true;
}

std::optional<GoalList::End> GoalSender::take(const msg::NavigatorStatus& status,
                                              const messaging::SampleInfo& info) {
  goals_.note_navigator(info);
  const bool pausing = is_pausing();
  if (const auto repeat = unconfirmed_.take(status)) order(repeat->kind, repeat->goal_id);
  const std::string text = list_.current() ? list_.current()->text : std::string();
  const std::uint64_t id = list_.current() ? list_.current()->id : 0;
  const bool waits = waits_at_goal(status);
  const auto end = list_.take(status, is_pausing() || waits);
  if (!end) {
    if (is_pausing() != pausing) show();
    return std::nullopt;
  }
  if (*end == GoalList::End::kArrived) {
    events_.add(EventLog::Level::kInfo, "web", "arrived: " + text);
    if (list_.current()) send_current();
    begin_next_round();
  } else {
    rounds_.end();
    // It may still be on its way.
    if (*end == GoalList::End::kNotTaken) order(msg::kGoalCancel, id);
    events_.add(EventLog::Level::kWarning, "web",
                *end == GoalList::End::kNotTaken
                    ? "the navigator has not received the goal " + text + ": send it again"
                    : "another client has taken the goal " + text + " away");
  }
  show();
  return end;
}

void GoalSender::show() {
  Json waiting = Json::array();
  for (const Goal& goal : list_.waiting()) waiting.push_back(goal_json(goal));
  Json json = {{"current", nullptr},
               {"waiting", std::move(waiting)},
               {"waits_s", nullptr},
               {"round", nullptr},
               {"exploring", exploring_},
               {"pausing", is_pausing()},
               {"exploration", Json::parse(exploration_)},
               {"interrupted", nullptr}};
  if (has_interrupted()) {
    json["interrupted"] = {
        {"text", interrupted_.empty() ? std::string() : interrupted_.front().text},
        {"waiting", interrupted_.empty() ? 0 : interrupted_.size() - 1},
        {"exploring", was_exploring_}};
  }
  if (list_.current()) {
    const Goal& goal = *list_.current();
    json["current"] = goal_json(goal);
    const double rest_s = wait_.goal() == goal.id ? wait_.rest_s(support::monotonic_ns()) : 0.0;
    if (rest_s > 0.0) json["waits_s"] = rounded(rest_s);
    if (rounds_.repeats()) json["round"] = {{"now", goal.round}, {"of", rounds_.rounds()}};
  }
  hub_.set(Channel::kGoals, text_of(json));
}

}  // namespace topogeo::web
