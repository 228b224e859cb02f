#include "answer.hpp"

#include <stdexcept>
#include <string>
#include <string_view>

#include "topogeo/messaging/message.hpp"

namespace topogeo::planner {

namespace {

msg::Route no_route(msg::RouteStatus status, std::string_view why) {
  msg::Route route;
  route.status(status);
  messaging::set_text_cut(route.message(), why);
  return route;
}

}  // namespace

std::optional<service::Goal> goal_from(const msg::Goal& message, msg::Route& refusal) {
  try {
    return service::from_msg(message);
  } catch (const std::invalid_argument& error) {
    refusal = no_route(msg::kRouteInvalidPoint, std::string("invalid goal: ") + error.what());
    return std::nullopt;
  }
}

msg::Route answer(const msg::Goal& goal, const planning::PlanningMaps& maps,
                  const std::optional<service::LivePose>& pose,
                  std::span<const Eigen::Vector2d> blocked_m,
                  const planning::GoalPlannerConfig& config) {
  msg::Route refusal;
  const auto wanted = goal_from(goal, refusal);
  if (!wanted) return refusal;
  if (maps.hybrid == nullptr && maps.graph == nullptr) {
    return no_route(msg::kRouteNoMap, "no map yet");
  }
  if (!maps.any()) {
    return no_route(msg::kRouteNoMap,
                    maps.graph == nullptr
                        ? "the map has no zone: the robot fits nowhere on it"
                        : "the map has no zone and no branch: the robot fits nowhere on it");
  }
  if (!pose) return no_route(msg::kRouteNoPose, "the robot has no pose yet");
  if (!localization::located(pose->status.state)) {
    return no_route(msg::kRouteNoPose,
                    std::string("the robot's pose is not known: ") + to_string(pose->status.state));
  }
  const planning::HybridRoute route = planning::plan_to_goal(maps, pose->T_map_robot.position_m(),
                                                             wanted->target, blocked_m, config);
  return service::to_msg(route, pose->T_map_robot.theta_rad, wanted->heading_rad);
}

}  // namespace topogeo::planner
