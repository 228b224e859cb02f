// Arriving: it stands, looks where it is, corrects what is left, and has arrived.
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "navigator_state.hpp"

namespace topogeo::navigation {
namespace {

constexpr int kCorrections = 5;
constexpr int kLooks = 3;  // a third of a circle each
constexpr double kLookTurn_rad = 2.1;
constexpr double kDegrees = 57.29578;

}  // namespace

// Something keeps it off the last centimetres: only the heading is left to be put right.
geometry::Velocity Navigator::State::settle_here() {
  corrections = kCorrections;
  guard_stop_ns.reset();
  blocked_ns.reset();
  follower.follow({}, way.route().heading_rad);
  return stop(NavigatorState::kDriving, HaltReason::kNone,
              "gets no nearer to the goal; turns to its heading");
}

// Stops made while it turns confirm a pose that the localizer is not sure of, or change it.
geometry::Velocity Navigator::State::look_at_goal(const geometry::Pose2& T_map_robot) {
  ++looks;
  settle_ns.reset();
  follower.follow({}, geometry::wrap_angle(T_map_robot.theta_rad + kLookTurn_rad));
  return stop(NavigatorState::kDriving, HaltReason::kNone,
              "is there by an unsure pose; turns to look around");
}

geometry::Velocity Navigator::State::settle(const geometry::Pose2& T_map_robot) {
  constexpr double kLongest = 3.0;  // of the time to settle, for a pose that does not come
  const double stood_s = since_s(*settle_ns);
  const bool seen = keeper.fix_ns().value_or(0) >=
                    *settle_ns + static_cast<std::int64_t>(0.5 * config.settle_s * 1e9);
  if (stood_s < config.settle_s || (!seen && stood_s < kLongest * config.settle_s)) {
    return stop(NavigatorState::kDriving, HaltReason::kNone, "is there; looks where exactly");
  }
  if (!keeper.tracking() && looks < kLooks) return look_at_goal(T_map_robot);
  const double off_m = (way.goal_m() - T_map_robot.position_m()).norm();
  const auto& heading_rad = way.route().heading_rad;
  const double off_rad =
      heading_rad ? std::fabs(geometry::wrap_angle(*heading_rad - T_map_robot.theta_rad)) : 0.0;
  const bool there = off_m <= config.arrival_m && off_rad <= config.arrival_rad;
  if (there || corrections >= kCorrections) {
    arrived = true;
    follower.forget();
    status.rest_m = 0.0;
    status.rest_s = 0.0;
    std::string message = say("has arrived, %.2f m", off_m);
    if (heading_rad) message += say(" and %.1f degrees", off_rad * kDegrees);
    message += keeper.tracking() ? " off by its own pose" : " off by a pose that it is not sure of";
    return stop(NavigatorState::kArrived, HaltReason::kNone, std::move(message));
  }
  ++corrections;
  settle_ns.reset();
  std::vector<planning::PathSample> path;
  if (off_m > config.arrival_m) {
    const std::array<Eigen::Vector2d, 2> line = {T_map_robot.position_m(), way.goal_m()};
    path = straight_path(line);
  }
  follower.follow(std::move(path), heading_rad);
  return stop(NavigatorState::kDriving, HaltReason::kNone,
              say("corrects %.2f m at the goal", off_m));
}

}  // namespace topogeo::navigation
