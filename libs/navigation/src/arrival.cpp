#include "arrival.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "topogeo/navigation/path_follower.hpp"
#include "topogeo/support/format.hpp"

#include "elapsed.hpp"

namespace topogeo::navigation {
namespace {

constexpr int kCorrections = 5;       // a remaining error is one of the pose,
constexpr int kMostCorrections = 12;  // or of wheels that cannot get nearer than this
constexpr double kPoor_m = 0.05;
constexpr int kManoeuvres = 3;  // of a base that cannot turn on the spot: each takes metres,
constexpr double kManoeuvred_m = 0.05;  // so it makes none for less
constexpr double kManoeuvred_rad = 0.06;
constexpr int kLooks = 3;              // a third of a circle each
constexpr double kLookTurn_rad = 2.1;  // three of them are a whole turn

}  // namespace

void Arrival::reset() {
  settle_ns_.reset();
  corrections_ = 0;
  looks_ = 0;
}

void Arrival::begin(std::int64_t now_ns) {
  settle_ns_ = now_ns;
  looked_ = false;
}

void Arrival::accept_position() {
  corrections_ = kMostCorrections;
}

ArrivalStep Arrival::step(const ArrivalView& view, std::int64_t now_ns) {
  constexpr double kLongest = 3.0;  // of the settling time, if no pose comes
  constexpr double kStands = 0.5;   // of the settling time, until the robot has come to rest
  const double stood_s = elapsed_s(*settle_ns_, now_ns);
  const bool seen = view.fix_ns.value_or(0) >=
                    *settle_ns_ + static_cast<std::int64_t>(kStands * config_.settle_s * 1e9);
  if (stood_s < config_.settle_s || (!seen && stood_s < kLongest * config_.settle_s)) {
    return {ArrivalStep::Kind::kStands, {}, {}, "at the goal, checking its position"};
  }
  const bool steers = config_.guard.minimum_turning_radius_m > 0.0;
  if (!view.tracking && looks_ < kLooks && !steers) return look_around(view);
  const double off_m = (view.goal_m - view.T_map_robot.position_m()).norm();
  const double off_rad =
      view.heading_rad
          ? std::fabs(geometry::wrap_angle(*view.heading_rad - view.T_map_robot.theta_rad))
          : 0.0;
  const double near_m = std::max(config_.follower.arrival_m, steers ? kManoeuvred_m : 0.0);
  const double near_rad = std::max(config_.follower.arrival_rad, steers ? kManoeuvred_rad : 0.0);
  const bool there = off_m <= near_m && off_rad <= near_rad;
  const int turning_tries = off_m > kPoor_m ? kMostCorrections : kCorrections;
  const int tries = steers ? kManoeuvres : turning_tries;
  if (!there && corrections_ < tries) return correct(view, off_m);
  std::string message = fmt::format("arrived (estimated error {:.0f} cm", 100.0 * off_m);
  if (view.heading_rad) {
    message += fmt::format(" and {:.1f} degrees", off_rad * 180.0 / std::numbers::pi);
  }
  message += view.tracking ? ")" : ", position unsure)";
  return {ArrivalStep::Kind::kArrived, {}, {}, std::move(message)};
}

// Stops made while turning confirm or change an uncertain pose.
ArrivalStep Arrival::look_around(const ArrivalView& view) {
  ++looks_;
  settle_ns_.reset();
  return {ArrivalStep::Kind::kMoves,
          {},
          geometry::wrap_angle(view.T_map_robot.theta_rad + kLookTurn_rad),
          "at the goal, position unsure; turns to look around"};
}

ArrivalStep Arrival::correct(const ArrivalView& view, double off_m) {
  ++corrections_;
  settle_ns_.reset();
  std::vector<planning::PathSample> path;
  if (off_m > config_.follower.arrival_m) {
    const std::array<Eigen::Vector2d, 2> line = {view.T_map_robot.position_m(), view.goal_m};
    path = straight_path(line);
  }
  return {ArrivalStep::Kind::kMoves, std::move(path), view.heading_rad,
          fmt::format("corrects {:.2f} m at the goal", off_m)};
}

}  // namespace topogeo::navigation
