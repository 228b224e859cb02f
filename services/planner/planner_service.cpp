#include "planner_service.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/navigation_conversions.hpp"
#include "topogeo/support/log.hpp"

#include "answer.hpp"

namespace topogeo::planner {

namespace {

/// Tiles of an update arrive one by one, in any order: the map is taken when they have settled.
constexpr std::chrono::milliseconds kMapPeriod{100};

/// A robot that could not start where it was may be able to from this far.
constexpr double kMoved_m = 0.1;

bool is_on_branches(const msg::Route& route) {
  return std::ranges::any_of(route.parts(), [](const msg::RoutePart& part) {
    return part.on() == msg::kPlannedOnBranch || part.on() == msg::kPlannedOnVirtualBranch;
  });
}

}  // namespace

PlannerService::PlannerService(service::Service& service)
    : service_(service),
      live_map_(service),
      live_graph_(service),
      routes_(service.advertise<msg::Route>()) {
  service.subscribe<msg::LivePose>([this](const msg::LivePose& pose) { on_pose(pose); },
                                   {.main_input = true});
  service.subscribe<msg::Blockages>([this](const msg::Blockages& report) { on_blockages(report); });
  service.subscribe<msg::Goal>([this](const msg::Goal& goal) { on_goal(goal); });
  service.subscribe<msg::NavigatorStatus>(
      [this](const msg::NavigatorStatus& status) {
        if (goal_.take(status)) begin();
      },
      {}, [this](const messaging::SampleInfo&) { goal_.lose_navigator(); });
  service.loop().add_timer(kMapPeriod, [this] { take_maps(); });
  for (const char* counter :
       {"goals", "routes_found", "routes_on_branches", "routes_refused", "map_version"}) {
    service_.status().set_counter(counter, 0.0);
  }
  service_.status().set_state(msg::kServiceRunning);
  note_what_is_missing();
}

void PlannerService::note_what_is_missing() {
  const bool located = pose_ && localization::located(pose_->status.state);
  service_.status().set_waits_for(!map_ && !graph_ ? "a map" : (located ? "" : "a pose"));
}

void PlannerService::on_pose(const msg::LivePose& message) {
  // Localizer and navigator may both publish a pose: only the one used for driving counts.
  const bool of_navigator = message.mode() == msg::kModeMarkov;
  const bool by_markov =
      service_.setup().config.config.navigator.pose_source == navigation::PoseSource::kMarkov;
  if (of_navigator != by_markov) return;
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
    goal_.cancel(message);
    return;
  }
  // A goal that the navigator refuses is answered, but the robot continues to its previous goal.
  msg::Route refusal;
  if (!goal_from(message, refusal)) {
    send(message, refusal);
    throw std::invalid_argument(refusal.message().to_string());
  }
  service_.status().add_to_counter("goals");
  if (goal_.add(message)) begin();
}

void PlannerService::begin() {
  take_map();
  take_graph();
  note_what_is_missing();
  plan();
}

void PlannerService::take_maps() {
  const bool map_changed = take_map();
  const bool graph_changed = take_graph();
  if (!map_changed && !graph_changed) return;
  note_what_is_missing();
  // A robot driving along the grid must not get a new route for each new branch.
  if (map_changed || !map_ || refused_at_ || on_branches_) plan();
}

bool PlannerService::take_graph() {
  std::shared_ptr<const topomap::GlobalMap> graph;
  try {
    graph = live_graph_.map();
  } catch (const std::invalid_argument& error) {
    service_.status().fault("invalid map", error.what());
    return false;
  }
  if (graph == graph_) return false;
  graph_ = std::move(graph);
  service_.status().set_counter("map_branches", static_cast<double>(graph_->branches.size()));
  return true;
}

bool PlannerService::take_map() {
  std::shared_ptr<const planning::HybridMap> map;
  try {
    map = live_map_.map();
  } catch (const std::invalid_argument& error) {
    service_.status().fault("invalid hybrid map", error.what());
    return false;
  }
  if (map == map_) return false;  // the rest of the update is under way
  map_ = std::move(map);
  map_version_ = live_map_.version();
  messaging::StatusPublisher& status = service_.status();
  status.set_counter("map_version", static_cast<double>(map_version_));
  status.set_counter("map_zones", map_ ? static_cast<double>(map_->zones().zones.size()) : 0.0);
  status.set_counter("map_nodes", map_ ? static_cast<double>(map_->nodes().size()) : 0.0);
  return true;
}

void PlannerService::plan() {
  if (!goal_.chosen()) return;
  const msg::Goal& goal = *goal_.chosen();
  msg::Route route;
  try {
    const pipeline::Config& config = service_.setup().config.config;
    route = answer(goal, {map_.get(), graph_.get()}, pose_, blockages_.points_m,
                   {config.planner, config.hybrid_planner, config.planning});
  } catch (const std::invalid_argument& error) {
    service_.status().fault("route not sent", error.what());
    return;
  }
  const bool found = route.status() == msg::kRouteFound;
  refused_at_.reset();
  if (!found && pose_) refused_at_ = pose_->T_map_robot;
  if (!send(goal, route)) return;
  on_branches_ = is_on_branches(route);
  if (on_branches_) service_.status().add_to_counter("routes_on_branches");
  spdlog::debug("goal {}: {}", goal.goal_id(),
                found ? std::to_string(route.length_m()) + " m" : route.message().to_string());
}

bool PlannerService::send(const msg::Goal& goal, msg::Route& route) {
  messaging::set_header(route, service_.robot_id(), pose_ ? pose_->stamp_ns : goal.stamp_ns(),
                        sent_++);
  route.goal_id(goal.goal_id());
  route.map_version(map_ ? map_version_ : 0);
  route.graph_version(graph_ ? graph_->version : 0);
  route.blockages_version(blockages_.version);
  if (!service_.send(routes_, route, "route")) return false;
  const bool found = route.status() == msg::kRouteFound;
  service_.status().add_to_counter(found ? "routes_found" : "routes_refused");
  return true;
}

}  // namespace topogeo::planner
