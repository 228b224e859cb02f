#include "orders/exploration_sender.hpp"

#include <chrono>
#include <stdexcept>
#include <utility>

#include "topogeo/service/conversions.hpp"
#include "topogeo/service/navigation_conversions.hpp"

#include "channels/event_log.hpp"
#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

constexpr std::chrono::milliseconds kExplorationPeriod{200};

}  // namespace

ExplorationSender::ExplorationSender(service::Service& service, GoalSender& goals, EventLog& events,
                                     const RobotView& robot, std::function<ExploredFloor()> floor)
    : service_(service), goals_(goals), events_(events), robot_(robot), floor_(std::move(floor)) {
  timer_ = service_.loop().add_timer(kExplorationPeriod, [this] { step(); });
}

ExplorationSender::~ExplorationSender() {
  service_.loop().cancel_timer(timer_);
}

Answer ExplorationSender::start() {
  const auto& pose = robot_.pose();
  if (!pose) return error_answer(409, "the robot does not know its position");
  if (pose->mode() == msg::kModeLocalization) {
    return error_answer(
        409, "the map stays as it is now; to explore, press “Start mapping” in the view Correct");
  }
  if (!goals_.has_navigator()) return error_answer(409, "no navigator is connected");
  exploration_.start(service_.setup().config.config.exploration);
  goal_id_ = 0;
  goals_.set_exploring(true);
  events_.add(EventLog::Level::kInfo, "web", "explores");
  return {202, "{}"};
}

void ExplorationSender::stop() {
  if (exploration_.running()) end();
}

void ExplorationSender::end() {
  events_.add(EventLog::Level::kInfo, "web", "explored: " + exploration_.summary());
  exploration_.stop();
  newest_ = {};
  goals_.set_exploring(false);
}

void ExplorationSender::take(const msg::NavigatorStatus& status,
                             std::optional<GoalList::End> end_of_goal) {
  if (!exploration_.running()) return;
  if (end_of_goal == GoalList::End::kTakenOver) return end();
  try {
    navigator_ = service::from_msg(status);
  } catch (const std::invalid_argument&) {  // ignored, because the next status comes soon
  }
}

void ExplorationSender::step() {
  // A target does not count as out of reach while the navigator is absent or paused.
  if (!exploration_.running() || !goals_.has_navigator() || goals_.is_pausing()) return;
  try {
    newest_ = floor_();
  } catch (const std::invalid_argument&) {  // an incomplete map: keep the previous one
  }
  navigation::NavigatorStatus navigator = navigator_;
  navigator.T_map_robot.reset();
  const auto& pose = robot_.pose();
  if (pose && pose->state() == msg::kStateTracking) {
    navigator.T_map_robot = service::from_msg(pose->T_map_robot());
  }
  const bool taken = goal_id_ != 0 && navigator.goal_id == goal_id_;
  const auto goal = exploration_.step(newest_, navigator, taken, kExplorationPeriod);
  if (goal) goal_id_ = goals_.send_to(goal->T_map_goal, goal->text);
  const std::size_t visited = exploration_.visited();
  const std::size_t given_up = exploration_.given_up();
  if (!exploration_.done()) return goals_.show_exploration(visited, given_up, false);
  // The robot may still drive to a target that was given up.
  if (goals_.under_way()) goals_.cancel();
  end();
  goals_.show_exploration(visited, given_up, true);
}

}  // namespace topogeo::web
