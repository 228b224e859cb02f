#include "navigate/goal_client.hpp"

#include <chrono>
#include <random>
#include <stdexcept>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/navigation_conversions.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"

#include "common/program_connection.hpp"

namespace topogeo::cli {
namespace {

/// A number that is unique among all clients and never 0.
std::uint64_t new_goal_id() {
  std::random_device random;
  return (static_cast<std::uint64_t>(random()) << 16U) + (random() & 0xFFFFU) + 1;
}

supervision::RouteAnswer to_answer(const msg::Route& route) {
  supervision::RouteAnswer answer;
  answer.goal_id = route.goal_id();
  answer.refused = route.status() != msg::kRouteFound && route.status() != msg::kRouteNoMap &&
                   route.status() != msg::kRouteNoPose;
  answer.reason = route.message().to_string();
  if (route.has_nearest_reachable()) {
    answer.reason += fmt::format("; ({:.2f}, {:.2f}) is the nearest place that can be reached",
                                 route.nearest_reachable().x_m(), route.nearest_reachable().y_m());
  }
  return answer;
}

}  // namespace

GoalClient::GoalClient(const messaging::Participant& participant, messaging::EventLoop& loop,
                       std::string robot_id)
    : robot_id_(std::move(robot_id)),
      client_id_(support::process_name()),
      loop_(loop),
      goals_(participant),
      service_statuses_(participant),
      statuses_(participant),
      routes_(participant),
      // Invalid messages are ignored: the services count them, and here the map is only drawn.
      live_map_(participant, loop, [this](const auto& message, const auto& use) {
        if (!is_own(message)) return;
        try {
          use(message);
        } catch (const std::invalid_argument&) {
          return;
        }
      }) {
  loop_.add(goals_);
  listen();
}

void GoalClient::listen() {
  using messaging::SampleInfo;
  loop_.add<msg::ServiceStatus>(
      service_statuses_,
      [this](const msg::ServiceStatus& status, const SampleInfo& info) {
        if (is_own(status) && status.state() != msg::kServiceStopped) {
          services_.update(status, info);
          programs_[status.service().to_string()] = info.writer;
          note_busy();
        }
      },
      [this](const SampleInfo& info) {
        services_.remove(info);
        note_busy();
      });
  loop_.add<msg::NavigatorStatus>(statuses_,
                                  [this](const msg::NavigatorStatus& status, const SampleInfo&) {
                                    if (is_own(status)) take_status(status);
                                  });
  loop_.add<msg::Route>(routes_, [this](const msg::Route& route, const SampleInfo&) {
    if (!is_own(route) || goal_id_ == 0 || route.goal_id() != goal_id_) return;
    if (watch_) watch_->add(to_answer(route));
    if (!route_ && route.status() == msg::kRouteFound && !route.points().empty()) route_ = route;
  });
}

// Ignores a status that breaks the wire contract: the next one comes soon.
void GoalClient::take_status(const msg::NavigatorStatus& status) {
  try {
    status_ = service::from_msg(status);
  } catch (const std::invalid_argument&) {
    return;
  }
  ++statuses_received_;
  if (watch_) watch_->add(*status_, support::monotonic_s());
}

void GoalClient::note_busy() {
  if (watch_) watch_->set_busy(!too_busy().empty(), support::monotonic_s());
}

std::string GoalClient::too_busy() const {
  const std::string names = services_.short_of_cpu();
  return names.empty() ? "" : "the robot's machine is too busy: the CPU is short for " + names;
}

std::string GoalClient::missing() const {
  std::string names;
  for (const char* name : {"planner", "navigator"}) {
    if (services_.find(name) == nullptr || !goals_.connected_with(programs_.at(name)))
      names += (names.empty() ? "" : " and no ") + std::string(name);
  }
  return names;
}

void GoalClient::send(service::Goal goal, double patience_s) {
  const bool order = goal.kind == msg::kGoalCancel || goal.kind == msg::kGoalPause ||
                     goal.kind == msg::kGoalResume;
  goal.client_id = client_id_;
  if (!order) {
    goal.goal_id = goal_id_ = new_goal_id();
    route_.reset();
    watch_.emplace(goal_id_, patience_s, support::monotonic_s());
    note_busy();
  }
  if (!goals_.write(service::to_msg(goal, robot_id_, support::wall_clock_ns(), sent_++))) {
    throw std::runtime_error("the goal could not be sent");
  }
}

void GoalClient::cancel() {
  if (goal_id_ == 0) return;
  service::Goal order;
  order.kind = msg::kGoalCancel;
  order.goal_id = goal_id_;
  send(order);
}

bool GoalClient::delivered(support::Patience& patience) {
  return is_delivered(goals_, patience);
}

std::optional<supervision::GoalEnd> GoalClient::end() {
  return watch_ ? watch_->check(support::monotonic_s()) : std::nullopt;
}

bool GoalClient::stands() const {
  return !status_ ||
         (status_->command.linear_m_per_s == 0.0 && status_->command.angular_rad_per_s == 0.0 &&
          status_->state != navigation::NavigatorState::kDriving);
}

std::shared_ptr<const planning::HybridMap> GoalClient::map() {
  try {
    return live_map_.map();
  } catch (const std::invalid_argument&) {
    return nullptr;
  }
}

planning::HybridRoute route_to_draw(const msg::Route& route) {
  planning::HybridRoute out;
  out.status = planning::RouteStatus::kFound;
  out.length_m = route.length_m();
  out.cost_m = route.cost_m();
  out.min_clearance_m = route.min_clearance_m();
  for (const std::uint16_t zone : route.zones()) out.zones.push_back(zone);
  for (const std::uint32_t node : route.node_ids()) out.nodes.push_back(node);
  for (const msg::BranchPoint& point : route.points()) {
    out.points_m.emplace_back(point.x_m(), point.y_m());
  }
  out.parts = service::route_parts_from_msg(route);
  return out;
}

}  // namespace topogeo::cli
