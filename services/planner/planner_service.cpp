#include "planner_service.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>

#include <spdlog/spdlog.h>

#include "topogeo/messaging/message.hpp"

namespace topogeo::planner {

namespace {

/// Elements of an update come one by one, in an order of their own: look at the map when they have
/// settled.
constexpr std::chrono::milliseconds kMapPeriod{100};

const topomap::MapNode* find_node(const topomap::GlobalMap& map, std::uint32_t id) {
  const auto found = std::find_if(map.nodes.begin(), map.nodes.end(),
                                  [id](const topomap::MapNode& node) { return node.id == id; });
  return found == map.nodes.end() ? nullptr : &*found;
}

bool is_known(const service::LivePose& pose) {
  return pose.belief.state == localization::LocalizationState::kTracking ||
         pose.belief.state == localization::LocalizationState::kAmbiguous;
}

msg::Route no_route(msg::RouteStatus status, std::string_view why) {
  msg::Route route;
  route.status(status);
  messaging::set_text_cut(route.message(), why);
  return route;
}

}  // namespace

msg::Route answer(const msg::Goal& goal, const std::optional<topomap::GlobalMap>& map,
                  const std::optional<service::LivePose>& pose,
                  const planning::PlanningConfig& config) {
  if (!map) return no_route(msg::kRouteNoMap, "no map yet");
  if (!pose || !is_known(*pose)) {
    return no_route(msg::kRouteNoPose, "the robot's pose is not known");
  }
  Eigen::Vector2d target_m(goal.target().x_m(), goal.target().y_m());
  if (goal.kind() == msg::kGoalNode) {
    const topomap::MapNode* node = find_node(*map, goal.node_id());
    if (node == nullptr) {
      return no_route(msg::kRouteUnreachable,
                      "the map has no node " + std::to_string(goal.node_id()));
    }
    target_m = node->position_m;
  }
  const planning::PlanResult result =
      planning::plan(*map, pose->T_map_robot.position_m(), target_m, config);
  if (!result.found()) {
    const bool empty = result.status == planning::PlanStatus::kEmptyMap;
    return no_route(empty ? msg::kRouteNoMap : msg::kRouteUnreachable, result.reason);
  }
  msg::Route route = service::to_msg(result.route);
  route.status(msg::kRouteFound);
  return route;
}

PlannerService::PlannerService(service::Service& service)
    : service_(service),
      elements_(service.participant()),
      poses_(service.participant()),
      goals_(service.participant()),
      routes_(service.participant()) {
  messaging::EventLoop& loop = service_.loop();
  loop.add<msg::MapElement>(
      elements_,
      [this](const msg::MapElement& message, const messaging::SampleInfo& info) {
        on_element(message, info);
      },
      [this](const messaging::SampleInfo& info) {
        // A map_store that has gone leaves its last map standing; only a disposal takes away.
        if (info.state != messaging::InstanceState::kDisposed) return;
        mirror_.remove(info.instance);
        map_changed_ = true;
      });
  loop.add<msg::LivePose>(poses_, [this](const msg::LivePose& message,
                                         const messaging::SampleInfo&) { on_pose(message); });
  loop.add<msg::Goal>(
      goals_, [this](const msg::Goal& message, const messaging::SampleInfo&) { on_goal(message); });
  loop.add(routes_);
  loop.add_timer(kMapPeriod, [this] { take_map(); });
  for (const char* counter : {"goals", "routes_found", "routes_refused", "map_version"}) {
    service_.status().set_counter(counter, 0.0);
  }
  service_.status().set_state(msg::kServiceRunning);
}

void PlannerService::on_element(const msg::MapElement& message, const messaging::SampleInfo& info) {
  if (!service_.is_own(message)) return;
  try {
    mirror_.put(message, info.instance);
    map_changed_ = true;
  } catch (const std::invalid_argument& error) {
    service_.status().fault("invalid map element", error.what());
  }
}

void PlannerService::on_pose(const msg::LivePose& message) {
  if (!service_.is_own(message)) return;
  try {
    pose_ = service::from_msg(message);
  } catch (const std::invalid_argument& error) {
    service_.status().fault("invalid pose", error.what());
    return;
  }
  if (goal_ && waits_for_pose_ && is_known(*pose_)) plan();
}

void PlannerService::on_goal(const msg::Goal& message) {
  if (!service_.is_own(message)) return;
  service_.status().add_to_counter("goals");
  goal_.reset();  // the one before needs no answer on a newer map
  take_map();
  if (message.kind() == msg::kGoalCancel) return;
  goal_ = message;
  plan();
}

void PlannerService::take_map() {
  if (!map_changed_) return;
  std::optional<topomap::GlobalMap> map = mirror_.map();
  if (!map) return;  // the rest of the update is on its way
  map_changed_ = false;
  map_ = std::move(map);
  messaging::StatusPublisher& status = service_.status();
  status.set_counter("map_version", static_cast<double>(map_->version));
  status.set_counter("map_nodes", static_cast<double>(map_->nodes.size()));
  status.set_counter("map_branches", static_cast<double>(map_->branches.size()));
  if (goal_) plan();
}

void PlannerService::plan() {
  msg::Route route;
  try {
    route = answer(*goal_, map_, pose_, service_.setup().config.config.planning);
  } catch (const std::invalid_argument& error) {
    service_.status().fault("route not sent", error.what());
    return;
  }
  waits_for_pose_ = route.status() == msg::kRouteNoPose;
  messaging::set_header(route, service_.robot_id(), pose_ ? pose_->stamp_ns : goal_->stamp_ns(),
                        sent_++);
  route.goal_id(goal_->goal_id());
  route.map_version(map_ ? map_->version : 0);
  if (!service_.send(routes_, route, "route")) return;
  const bool found = route.status() == msg::kRouteFound;
  service_.status().add_to_counter(found ? "routes_found" : "routes_refused");
  spdlog::debug("goal {}: {}", goal_->goal_id(),
                found ? std::to_string(route.length_m()) + " m" : route.message().to_string());
}

}  // namespace topogeo::planner
