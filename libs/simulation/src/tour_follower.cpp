#include "topogeo/simulation/tour_follower.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::simulation {
namespace {

constexpr double kArrived_m = 0.05;  // from a point of the tour; limits the cutting of corners

void check_drive(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw std::invalid_argument(std::string(name) + ": expected a number in [" + std::to_string(low) +
                              ", " + std::to_string(high) + "], got " + std::to_string(value));
}

// Relative speed for a heading error: full when aligned, zero from 60 degrees on.
double share_of_speed(double heading_error_rad) {
  constexpr double kCosOfStop = 0.5;
  const double aim = geometry::sincos(heading_error_rad).cos;
  return std::clamp((aim - kCosOfStop) / (1.0 - kCosOfStop), 0.0, 1.0);
}

}  // namespace

TourFollower::TourFollower(const std::vector<Eigen::Vector2d>& tour_m, const DriveOptions& options)
    : options_(options) {
  check_drive("speed_m_per_s", options.speed_m_per_s, 0.01, 10.0);
  check_drive("turn_rad_per_s", options.turn_rad_per_s, 0.01, 10.0);
  check_drive("acceleration_m_per_s2", options.acceleration_m_per_s2, 0.01, 10.0);
  check_drive("lookahead_m", options.lookahead_m, 0.05, 5.0);
  check_drive("turn_gain_per_s", options.turn_gain_per_s, 0.01, 10.0);
  check_drive("keep_off_m", options.keep_off_m, 0.0, 5.0);
  for (const Eigen::Vector2d& point_m : tour_m) {
    if (path_m_.empty() || point_m != path_m_.back()) path_m_.push_back(point_m);
  }
  if (path_m_.size() < 2) {
    throw std::invalid_argument("tour: expected two different waypoints or more, got " +
                                std::to_string(path_m_.size()));
  }
  for (std::size_t i = 1; i < path_m_.size(); ++i) {
    rest_m_ += (path_m_[i] - path_m_[i - 1]).norm();
  }
}

geometry::Pose2 TourFollower::start() const {
  const Eigen::Vector2d first_m = path_m_[1] - path_m_[0];
  return {path_m_[0].x(), path_m_[0].y(), geometry::atan2(first_m.y(), first_m.x())};
}

double TourFollower::rest_m() const {
  return std::max(rest_m_, 0.0);
}

// Advances until it is lookahead_m away from the robot or at the end.
void TourFollower::run_ahead(const Eigen::Vector2d& robot_m) {
  constexpr double kStep_m = 0.01;
  while (!ahead_at_end() && (ahead_m() - robot_m).norm() < options_.lookahead_m) {
    const double leg_m = (path_m_[next_] - path_m_[next_ - 1]).norm();
    const double step_m = std::min(kStep_m, leg_m - along_m_);
    along_m_ += step_m;
    rest_m_ -= step_m;
    if (along_m_ >= leg_m) {
      ++next_;
      along_m_ = 0.0;
    }
  }
}

Eigen::Vector2d TourFollower::ahead_m() const {
  if (ahead_at_end()) return path_m_.back();
  const Eigen::Vector2d leg_m = path_m_[next_] - path_m_[next_ - 1];
  return path_m_[next_ - 1] + leg_m * (along_m_ / leg_m.norm());
}

std::optional<Velocity> TourFollower::next(const geometry::Pose2& T_world_robot, double dt_s,
                                           double free_ahead_m) {
  run_ahead(T_world_robot.position_m());
  const Eigen::Vector2d to_ahead_m = ahead_m() - T_world_robot.position_m();
  const double left_m = rest_m() + to_ahead_m.norm();
  if (ahead_at_end() && left_m < kArrived_m) return std::nullopt;
  const double error_rad = geometry::wrap_angle(geometry::atan2(to_ahead_m.y(), to_ahead_m.x()) -
                                                T_world_robot.theta_rad);
  const double acceleration = options_.acceleration_m_per_s2;
  double wanted_m_per_s = std::min(options_.speed_m_per_s * share_of_speed(error_rad),
                                   std::max(0.05, std::sqrt(2.0 * acceleration * left_m) * 0.9));
  // Uses half the acceleration, because the base does not brake at once.
  const double room_m = std::max(free_ahead_m - options_.keep_off_m, 0.0);
  wanted_m_per_s = std::min(wanted_m_per_s, std::sqrt(acceleration * room_m));
  speed_m_per_s_ = std::min(speed_m_per_s_ + acceleration * dt_s, wanted_m_per_s);
  return Velocity{speed_m_per_s_, std::clamp(options_.turn_gain_per_s * error_rad,
                                             -options_.turn_rad_per_s, options_.turn_rad_per_s)};
}

}  // namespace topogeo::simulation
