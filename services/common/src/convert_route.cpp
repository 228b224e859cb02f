// Goals, and the planner's replies to them.
#include "topogeo/messaging/message.hpp"
#include "topogeo/planning/motion_primitives.hpp"
#include "topogeo/service/conversions.hpp"

#include "convert.hpp"

namespace topogeo::service {

using detail::check;
using detail::check_bound;
using detail::finite;
using detail::to_point;

namespace {

template <class Alternative>
const Alternative& target_as(const Goal& goal, std::string_view expected) {
  const auto* target = std::get_if<Alternative>(&goal.target);
  check(target != nullptr, "target", expected);
  return *target;
}

}  // namespace

msg::Goal to_msg(const Goal& goal, std::string_view robot_id, std::int64_t stamp_ns,
                 std::uint64_t sequence_number) {
  msg::Goal out;
  messaging::set_header(out, robot_id, stamp_ns, sequence_number);
  out.goal_id(goal.goal_id);
  messaging::set_client_id(out, goal.client_id);
  out.kind(goal.kind);
  if (goal.kind == msg::kGoalPosition) {
    out.target(to_point(target_as<Eigen::Vector2d>(goal, "a point")));
  } else if (goal.kind == msg::kGoalNode) {
    out.node_id(target_as<planning::NodeNumber>(goal, "the number of a node").id);
  } else if (goal.kind == msg::kGoalPlace) {
    messaging::set_text(out.place(), target_as<std::string>(goal, "the name of a place"), "place");
  }
  out.has_heading(goal.heading_rad.has_value());
  out.heading_rad(goal.heading_rad.value_or(0.0));
  out.look_around(goal.look_around);
  return out;
}

Goal from_msg(const msg::Goal& message) {
  check(message.kind() <= msg::kGoalResume, "kind", "0 to 5");
  Goal goal;
  goal.goal_id = message.goal_id();
  goal.client_id = message.client_id().to_string();
  goal.kind = message.kind();
  if (goal.kind == msg::kGoalPosition) {
    goal.target = Eigen::Vector2d(finite(message.target().x_m(), "target.x_m"),
                                  finite(message.target().y_m(), "target.y_m"));
  } else if (goal.kind == msg::kGoalNode) {
    goal.target = planning::NodeNumber{message.node_id()};
  } else if (goal.kind == msg::kGoalPlace) {
    check(message.place().size() > 0, "place", "a name");
    goal.target = message.place().to_string();
  }
  if (message.has_heading()) goal.heading_rad = finite(message.heading_rad(), "heading_rad");
  goal.look_around = message.look_around();
  return goal;
}

msg::Route to_msg(const planning::HybridRoute& route, double start_heading_rad,
                  std::optional<double> final_heading_rad) {
  msg::Route out;
  out.status(static_cast<msg::RouteStatus>(route.status));  // same values, see planning.idl
  messaging::set_text_cut(out.message(), route.reason);
  out.has_nearest_reachable(route.nearest_reachable_m.has_value());
  if (route.nearest_reachable_m) out.nearest_reachable(to_point(*route.nearest_reachable_m));
  out.has_heading(final_heading_rad.has_value());
  out.heading_rad(final_heading_rad.value_or(0.0));
  if (!route.found()) return out;
  check_bound("zones", route.zones.size(), msg::kMaxRouteNodes);
  check_bound("node_ids", route.nodes.size(), msg::kMaxRouteNodes);
  check_bound("points", route.points_m.size(), msg::kMaxRoutePoints);
  check_bound("parts", route.parts.size(), msg::kMaxRouteNodes);
  out.length_m(route.length_m);
  out.cost_m(route.cost_m);
  out.min_clearance_m(route.min_clearance_m);
  out.zones(route.zones);
  out.node_ids(route.nodes);
  for (std::size_t i = 0; i < route.points_m.size(); ++i) {
    out.points().push_back(detail::to_branch_point(route.points_m[i], route.clearances_m.at(i)));
  }
  for (const planning::RoutePart& part : route.parts) {
    msg::RoutePart& entry = out.parts().emplace_back();
    entry.on(static_cast<msg::PlannedOn>(part.on));  // same values, see planning.idl
    entry.branch_id(part.branch_id);
    entry.first_point(static_cast<std::uint32_t>(part.first_point));
  }
  const auto primitives =
      planning::motion_primitives(route.points_m, start_heading_rad, final_heading_rad);
  check_bound("primitives", primitives.size(), msg::kMaxRoutePrimitives);
  for (const planning::MotionPrimitive& primitive : primitives) {
    msg::MotionPrimitive& entry = out.primitives().emplace_back();
    entry.kind(static_cast<msg::MotionKind>(primitive.kind));  // same values, see planning.idl
    entry.amount(primitive.amount);
  }
  return out;
}

std::vector<planning::RoutePart> route_parts_from_msg(const msg::Route& message) {
  std::vector<planning::RoutePart> parts;
  for (const msg::RoutePart& part : message.parts()) {
    check(part.on() <= msg::kPlannedOffBranch, "parts.on", "0 to 3");
    const bool ascends = parts.empty() || part.first_point() >= parts.back().first_point;
    check(ascends && part.first_point() < message.points().size(), "parts.first_point",
          "ascending numbers of points");
    parts.push_back(
        {static_cast<planning::PlannedOn>(part.on()), part.branch_id(), part.first_point()});
  }
  return parts;
}

navigation::RoutePlan route_plan_from_msg(const msg::Route& message,
                                          const planning::HybridMap* map) {
  check(message.status() <= msg::kRouteNoPose, "status", "0 to 10");
  navigation::RoutePlan plan;
  plan.goal_id = message.goal_id();
  plan.map_version = message.map_version();
  plan.blockages_version = message.blockages_version();
  plan.found = message.status() == msg::kRouteFound;
  plan.reason = message.message().to_string();
  if (message.has_heading()) plan.heading_rad = finite(message.heading_rad(), "heading_rad");
  if (!plan.found) return plan;
  check(!message.points().empty(), "points", "at least 1 point");
  for (const msg::BranchPoint& point : message.points()) {
    plan.points_m.emplace_back(finite(point.x_m(), "points"), finite(point.y_m(), "points"));
    check(point.clearance_m() >= 0.0, "points.clearance_m", "a number from 0");
    plan.clearances_m.push_back(point.clearance_m());
  }
  plan.parts = route_parts_from_msg(message);
  for (const std::uint32_t node : message.node_ids()) {
    if (map == nullptr || node >= map->nodes().size()) continue;
    plan.nodes_m.push_back(map->nodes()[node].position_m);
  }
  return plan;
}

}  // namespace topogeo::service
