#include "navigate/goal_session.hpp"

#include <iostream>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <variant>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/render/route_picture.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/progress_bar.hpp"

#include "navigate/target_text.hpp"

namespace topogeo::cli {
namespace {

msg::GoalKind kind_of(const planning::Target& target) {
  if (std::holds_alternative<planning::NodeNumber>(target)) return msg::kGoalNode;
  return std::holds_alternative<std::string>(target) ? msg::kGoalPlace : msg::kGoalPosition;
}

/// "through 3 zones and 2 borders", or the share of the route on branches.
std::string planned_on(const msg::Route& route) {
  const planning::HybridRoute drawn = route_to_draw(route);
  const double branch_m = planning::length_on(drawn, planning::PlannedOn::kBranch);
  const double virtual_m = planning::length_on(drawn, planning::PlannedOn::kVirtualBranch);
  if (branch_m + virtual_m == 0.0) {
    return fmt::format("through {} zones and {} borders", route.zones().size(),
                       route.node_ids().size());
  }
  std::string text = fmt::format("{:.1f} m of it along branches", branch_m + virtual_m);
  if (virtual_m > 0.0) text += fmt::format(", {:.1f} m of these virtual", virtual_m);
  return text;
}

}  // namespace

void check_picture(const std::optional<std::filesystem::path>& picture) {
  if (!picture) return;
  try {
    static_cast<void>(render::picture_format(*picture));
  } catch (const std::exception& error) {
    throw service::UsageError(error.what());
  }
}

void add_goal_options(command_line::Command& app, GoalOptions& options) {
  app.add_option("--heading", options.heading_deg, "heading of the robot at the goal")
      ->check(command_line::range(-360.0, 360.0))
      ->type_name("DEG");
  app.add_flag("--look-around", options.look_around,
               "let a robot without a pose turn and move a little to find one");
  app.add_option("--picture", options.picture, "draw the route on the map as .png or .svg")
      ->type_name("FILE");
  constexpr double kLongest_s = 86400.0;
  app.add_option("--patience", options.patience_s,
                 "give the goal up when the robot has not moved for this many seconds, without the "
                 "time in which its services are short of CPU")
      ->check(command_line::range(1.0, kLongest_s))
      ->capture_default_str();
}

service::Goal to_goal(const GoalOptions& options) {
  constexpr std::size_t kLongestName = 64;  // idl
  if (options.target.empty() || options.target.size() > kLongestName) {
    throw service::UsageError(fmt::format(
        "goal '{}': expected X,Y in metres, #NODE or the name of a place, up to {} bytes",
        options.target, kLongestName));
  }
  service::Goal goal;
  goal.target = target_of(options.target);
  goal.kind = kind_of(goal.target);
  if (options.heading_deg) goal.heading_rad = *options.heading_deg * std::numbers::pi / 180.0;
  goal.look_around = options.look_around;
  return goal;
}

GoalSession::GoalSession(const messaging::Participant& participant, messaging::EventLoop& loop,
                         const std::string& robot_id, GoalOptions options)
    : options_(std::move(options)),
      goal_(to_goal(options_)),
      client_(participant, loop, robot_id),
      progress_(std::cerr, support::stderr_is_terminal(), supervision::terminal_columns()) {
  check_picture(options_.picture);
}

void GoalSession::send() {
  client_.send(goal_, options_.patience_s);
}

void GoalSession::tick() {
  if (client_.route() && !route_printed_) {
    route_printed_ = true;
    progress_.print(fmt::format("the route to {} is {:.1f} m long, {}", options_.target,
                                client_.route()->length_m(), planned_on(*client_.route())));
  }
  if (client_.route() && options_.picture && !drawn_) draw_route();
  if (client_.taken()) progress_.show(*client_.status(), support::monotonic_s());
}

void GoalSession::draw_route() {
  const std::shared_ptr<const planning::HybridMap> map = client_.map();
  if (!map) return;  // the map comes later
  drawn_ = true;
  const std::string title =
      fmt::format("to {}: {:.1f} m", options_.target, client_.route()->length_m());
  support::write_file_atomically(*options_.picture,
                                 render::route_picture(*map, route_to_draw(*client_.route()), title,
                                                       render::picture_format(*options_.picture)));
  progress_.print("the route is drawn in " + options_.picture->string());
}

}  // namespace topogeo::cli
