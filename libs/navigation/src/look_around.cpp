#include "look_around.hpp"

#include <cmath>
#include <numbers>

namespace topogeo::navigation {
namespace {

constexpr double kTurn_rad_s = 0.5;  // slow enough to match scans while turning
constexpr double kSpeed_m_s = 0.2;   // slow, without a pose
constexpr double kLeg_m = 1.0;       // about the distance between stops
constexpr double kRoomLeft_m = 0.3;  // remains free ahead of the body
constexpr double kFacing_rad = 0.1;  // turns on after the command to stop
constexpr double kStops_m = 0.1;     // moves on after the command to stop

}  // namespace

geometry::Velocity LookAround::step(const geometry::Pose2& T_odom_robot,
                                    const CollisionGuard& guard, std::int64_t now_ns) {
  const double free_m = guard.judge({kSpeed_m_s, 0.0}, now_ns).free_m;
  if (T_odom_last_) {
    const geometry::Pose2 moved = between(*T_odom_last_, T_odom_robot);
    turned_rad_ += std::fabs(moved.theta_rad);
    if (phase_ == Phase::kGo || minimum_radius_m_ > 0.0) gone_m_ += moved.position_m().norm();
    if (phase_ == Phase::kGo) leg_m_ += moved.position_m().norm();
  }
  T_odom_last_ = T_odom_robot;
  switch (phase_) {
    case Phase::kRound:
      if (minimum_radius_m_ > 0.0) return round_on_arcs(guard, now_ns);
      return round(T_odom_robot, free_m);
    case Phase::kFace:
      return face(T_odom_robot);
    case Phase::kGo:
      return go(free_m);
    case Phase::kFinished:
      return {};
  }
  return {};
}

geometry::Velocity LookAround::round(const geometry::Pose2& T_odom_robot, double free_m) {
  if (free_m > best_free_m_) {
    best_free_m_ = free_m;
    best_heading_rad_ = T_odom_robot.theta_rad;
  }
  if (turned_rad_ < 2.0 * std::numbers::pi) return {0.0, kTurn_rad_s};
  been_round_ = true;
  const bool may_go = gone_m_ + kStops_m < farthest_m_ && best_free_m_ > 2.0 * kRoomLeft_m;
  phase_ = may_go ? Phase::kFace : Phase::kFinished;
  return {};
}

geometry::Velocity LookAround::round_on_arcs(const CollisionGuard& guard, std::int64_t now_ns) {
  const bool far = gone_m_ + kStops_m >= farthest_m_;
  if (turned_rad_ < 2.0 * std::numbers::pi && !far) {
    // The turn goes on to the left: back with the wheels to the right.
    for (const double ahead : {ahead_, -ahead_}) {
      const geometry::Velocity arc{ahead * kSpeed_m_s, kSpeed_m_s / minimum_radius_m_};
      const GuardVerdict verdict = guard.judge(arc, now_ns);
      if (verdict.free_m <= kRoomLeft_m || verdict.allowed == geometry::Velocity{}) continue;
      ahead_ = ahead;
      return arc;
    }
  }
  const bool turned = turned_rad_ >= 2.0 * std::numbers::pi;
  been_round_ = true;
  phase_ = turned && !far ? Phase::kGo : Phase::kFinished;
  leg_m_ = 0.0;
  return {};
}

geometry::Velocity LookAround::face(const geometry::Pose2& T_odom_robot) {
  const double error_rad = geometry::wrap_angle(best_heading_rad_ - T_odom_robot.theta_rad);
  if (std::fabs(error_rad) > kFacing_rad) {
    return {0.0, error_rad > 0.0 ? kTurn_rad_s : -kTurn_rad_s};
  }
  phase_ = Phase::kGo;
  leg_m_ = 0.0;
  return {};
}

geometry::Velocity LookAround::go(double free_m) {
  if (leg_m_ < kLeg_m && gone_m_ + kStops_m < farthest_m_ && free_m > kRoomLeft_m) {
    return {kSpeed_m_s, 0.0};
  }
  phase_ = Phase::kRound;
  turned_rad_ = 0.0;
  best_free_m_ = 0.0;
  return {};
}

}  // namespace topogeo::navigation
