#include "goal_watch.hpp"

#include <string_view>

#include "topogeo/support/format.hpp"

namespace topogeo::cli {
namespace {

/// A navigator says five times a second what it does.
constexpr double kSilent_s = 10.0;

/// Another pose or map does not change it.
bool final_refusal(msg::RouteStatus status) {
  return status != msg::kRouteFound && status != msg::kRouteNoMap && status != msg::kRouteNoPose;
}

std::string text_of(const msg::NavigatorStatus& status) {
  const std::string message = status.message().to_string();
  return message.empty() ? "the navigator does not say why" : message;
}

}  // namespace

void GoalWatch::add(const msg::Route& route) {
  if (route.goal_id() != goal_id_) return;
  route_ = route.status();
  refusal_ = route.message().to_string();
  if (route.has_nearest_reachable()) {
    refusal_ += fmt::format("; ({:.2f}, {:.2f}) is the nearest place that can be reached",
                            route.nearest_reachable().x_m(), route.nearest_reachable().y_m());
  }
}

void GoalWatch::add(const msg::NavigatorStatus& status, double now_s) {
  alive_s_ = now_s;
  if (status.goal_id() != goal_id_) {
    replaced_ = taken_;
    return;
  }
  taken_ = true;
  replaced_ = false;
  if (status.state() == msg::kNavigatorDriving || status.reason() == msg::kHaltPaused) {
    driven_s_ = now_s;
  }
  status_ = status;
}

std::optional<GoalEnd> GoalWatch::look(double now_s) const {
  if (replaced_) return GoalEnd{false, "another goal took its place, or somebody cancelled it"};
  if (status_) {
    if (std::optional<GoalEnd> end = judge(*status_)) return end;
  }
  if (now_s - alive_s_ > kSilent_s) return GoalEnd{false, "the navigator is gone"};
  if (now_s - driven_s_ <= patience_s_) return std::nullopt;
  if (!taken_) return GoalEnd{false, "the navigator does not take the goal"};
  return GoalEnd{false, text_of(*status_)};
}

std::optional<GoalEnd> GoalWatch::judge(const msg::NavigatorStatus& status) const {
  if (status.state() == msg::kNavigatorArrived) return GoalEnd{true, ""};
  if (status.state() == msg::kNavigatorIdle) return GoalEnd{false, "the goal was cancelled"};
  if (status.state() != msg::kNavigatorStopped) return std::nullopt;
  if (status.reason() == msg::kHaltCancelled) return GoalEnd{false, "the goal was cancelled"};
  if (status.reason() == msg::kHaltNoRoute && route_ && final_refusal(*route_)) {
    return GoalEnd{false, "no route: " + (refusal_.empty() ? text_of(status) : refusal_)};
  }
  return std::nullopt;
}

}  // namespace topogeo::cli
