#include "planner_service.hpp"

#include <chrono>
#include <stdexcept>
#include <string>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/navigation_conversions.hpp"
#include "topogeo/support/log.hpp"

#include "answer.hpp"

namespace topogeo::planner {

namespace {

/// Tiles of an update come one by one, in an order of their own: the map is taken when they have
/// settled.
constexpr std::chrono::milliseconds kMapPeriod{100};

/// A robot that could not begin where it was may be able to from this far.
constexpr double kMoved_m = 0.1;

}  // namespace

PlannerService::PlannerService(service::Service& service)
    : service_(service), live_map_(service), routes_(service.advertise<msg::Route>()) {
  service.subscribe<msg::LivePose>([this](const msg::LivePose& pose) { on_pose(pose); },
                                   {.main_input = true});
  service.subscribe<msg::Blockages>([this](const msg::Blockages& report) { on_blockages(report); });
  service.subscribe<msg::Goal>([this](const msg::Goal& goal) { on_goal(goal); });
  service.loop().add_timer(kMapPeriod, [this] { take_map(); });
  for (const char* counter : {"goals", "routes_found", "routes_refused", "map_version"}) {
    service_.status().set_counter(counter, 0.0);
  }
  service_.status().set_state(msg::kServiceRunning);
  note_what_is_missing();
}

void PlannerService::note_what_is_missing() {
  const bool located = pose_ && localization::located(pose_->status.state);
  service_.status().set_waits_for(!map_ ? "a map" : (located ? "" : "a pose"));
}

void PlannerService::on_pose(const msg::LivePose& message) {
  const bool was_known = pose_ && localization::located(pose_->status.state);
  pose_ = service::from_msg(message);
  note_what_is_missing();
  if (!localization::located(pose_->status.state)) return;
  const bool moved =
      refused_at_ &&
      (refused_at_->position_m() - pose_->T_map_robot.position_m()).norm() >= kMoved_m;
  if (!was_known || moved) plan();
}

void PlannerService::on_blockages(const msg::Blockages& message) {
  blockages_ = service::from_msg(message);
  plan();
}

void PlannerService::on_goal(const msg::Goal& message) {
  if (message.kind() == msg::kGoalPause || message.kind() == msg::kGoalResume) return;
  if (message.kind() == msg::kGoalCancel) {
    if (goal_ && (message.goal_id() == 0 || message.goal_id() == goal_->goal_id())) goal_.reset();
    return;
  }
  service_.status().add_to_counter("goals");
  goal_.reset();  // the one before needs no answer on a newer map
  take_map();
  goal_ = message;
  plan();
}

void PlannerService::take_map() {
  std::shared_ptr<const planning::HybridMap> map;
  try {
    map = live_map_.map();
  } catch (const std::invalid_argument& error) {
    service_.status().fault("invalid hybrid map", error.what());
    return;
  }
  if (map == map_) return;  // the rest of the update is to come
  map_ = std::move(map);
  map_version_ = live_map_.version();
  note_what_is_missing();
  messaging::StatusPublisher& status = service_.status();
  status.set_counter("map_version", static_cast<double>(map_version_));
  status.set_counter("map_zones", map_ ? static_cast<double>(map_->zones().zones.size()) : 0.0);
  status.set_counter("map_nodes", map_ ? static_cast<double>(map_->nodes().size()) : 0.0);
  plan();
}

void PlannerService::plan() {
  if (!goal_) return;
  msg::Route route;
  try {
    route = answer(*goal_, map_.get(), pose_, blockages_.points_m,
                   service_.setup().config.config.hybrid_planner);
  } catch (const std::invalid_argument& error) {
    service_.status().fault("route not sent", error.what());
    return;
  }
  const bool found = route.status() == msg::kRouteFound;
  refused_at_.reset();
  if (!found && pose_) refused_at_ = pose_->T_map_robot;
  messaging::set_header(route, service_.robot_id(), pose_ ? pose_->stamp_ns : goal_->stamp_ns(),
                        sent_++);
  route.goal_id(goal_->goal_id());
  route.map_version(map_version_);
  route.blockages_version(blockages_.version);
  if (!service_.send(routes_, route, "route")) return;
  service_.status().add_to_counter(found ? "routes_found" : "routes_refused");
  spdlog::debug("goal {}: {}", goal_->goal_id(),
                found ? std::to_string(route.length_m()) + " m" : route.message().to_string());
}

}  // namespace topogeo::planner
