#include "topogeo/navigation/path_follower.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/navigation/arc_sweep.hpp"
#include "topogeo/navigation/drive_time.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kBrake = 0.7;           // of the acceleration: reserve of planned stops
constexpr double kTurnBrake = 0.6;       // the same for turns
constexpr double kSlowest_m_s = 0.03;    // bases do not move slower
constexpr double kSlowest_rad_s = 0.06;  // the same
constexpr double kLost_rad = 0.9;        // larger heading errors need a turn on the spot
constexpr double kCorner_rad = 0.02;     // less is no turn on the spot
constexpr double kSteers_m = 0.12;       // before and after a change of the curvature

}  // namespace

std::vector<planning::PathSample> straight_path(std::span<const Eigen::Vector2d> points_m,
                                                double step_m) {
  std::vector<planning::PathSample> samples;
  constexpr double kSame_m = 1e-6;
  double distance_m = 0.0;
  double heading_rad = 0.0;
  for (std::size_t i = 0, at = 0; i < points_m.size(); ++i) {
    const Eigen::Vector2d vector_m = points_m[i] - points_m[at];
    const double length_m = vector_m.norm();
    if (length_m < kSame_m) continue;
    const double before_rad = heading_rad;
    heading_rad = geometry::atan2(vector_m.y(), vector_m.x());
    const int steps = std::max(1, static_cast<int>(std::ceil(length_m / step_m)));
    for (int k = 0; k < steps; ++k) {
      const double share = static_cast<double>(k) / steps;
      const Eigen::Vector2d point_m = points_m[at] + share * vector_m;
      const bool corner = k == 0 && !samples.empty();
      samples.push_back({{point_m.x(), point_m.y(), heading_rad},
                         distance_m + share * length_m,
                         0.0,
                         corner ? geometry::wrap_angle(heading_rad - before_rad) : 0.0});
    }
    distance_m += length_m;
    at = i;
  }
  if (!samples.empty()) {
    const Eigen::Vector2d& end_m = points_m.back();
    samples.push_back({{end_m.x(), end_m.y(), heading_rad}, distance_m, 0.0, 0.0});
  }
  return samples;
}

PathFollower::PathFollower(const FollowerConfig& config)
    : config_(config), commands_(config.delay_s) {
  check(config);
}

std::size_t PathFollower::leg_end(std::size_t from) const {
  std::size_t end = from + 1;
  const auto goes_on = [this](std::size_t i) {
    return std::fabs(path_[i].turn_on_spot_rad) < kCorner_rad &&
           path_[i].backward == path_[i - 1].backward;
  };
  while (end + 1 < path_.size() && goes_on(end)) ++end;
  return std::min(end, path_.size() - 1);
}

void PathFollower::follow(std::vector<planning::PathSample> path,
                          std::optional<double> final_heading_rad,
                          std::span<const double> limits_m_per_s) {
  path_ = std::move(path);
  rest_times_s_ = rest_times_s(path_, limits_m_per_s, config_);
  final_heading_rad_ = final_heading_rad;
  active_ = true;
  progress_m_ = 0.0;
  off_m_ = 0.0;
  strayed_ = false;
  segment_ = 0;
  turn_from_rad_.reset();
  leg_from_m_.reset();
  finished_.clear();  // the base may never have executed them
  if (path_.size() < 2) {
    path_.clear();
    phase_ = Phase::kFinalTurn;
    return;
  }
  begin_leg(0);
}

void PathFollower::begin_leg(std::size_t from) {
  leg_begin_ = from;
  leg_end_ = leg_end(from);
  segment_ = from;
  progress_m_ = path_[from].distance_m;
  phase_ = Phase::kTurn;
  turn_from_rad_.reset();
  leg_from_m_.reset();
}

void PathFollower::forget() {
  active_ = false;
  path_.clear();
  phase_ = Phase::kDone;
}

double PathFollower::rest_s() const {
  if (path_.size() < 2) return 0.0;
  const std::size_t next = std::min(segment_ + 1, path_.size() - 1);
  const double piece_m = path_[next].distance_m - path_[segment_].distance_m;
  const double share =
      piece_m > 0.0 ? std::clamp((path_[next].distance_m - progress_m_) / piece_m, 0.0, 1.0) : 0.0;
  return rest_times_s_[next] + share * (rest_times_s_[segment_] - rest_times_s_[next]);
}

double PathFollower::rest_m() const {
  return path_.empty() ? 0.0 : std::max(0.0, path_.back().distance_m - progress_m_);
}

void PathFollower::commanded(const geometry::Velocity& command, std::int64_t now_ns) {
  commands_.add(command, now_ns);
}

std::vector<planning::MotionPrimitive> PathFollower::take_finished() {
  return std::exchange(finished_, {});
}

// The nearest place of the leg, near the last one.
PathFollower::Place PathFollower::locate(const geometry::Pose2& T_map_robot) {
  constexpr double kAhead_m = 1.0;
  const Eigen::Vector2d robot_m = T_map_robot.position_m();
  double best_m = HUGE_VAL;
  std::size_t best = segment_;
  double best_along_m = 0.0;
  for (std::size_t i = segment_; i < leg_end_; ++i) {
    if (path_[i].distance_m > progress_m_ + kAhead_m) break;
    const Eigen::Vector2d from_m = path_[i].T_map_robot.position_m();
    const Eigen::Vector2d vector_m = path_[i + 1].T_map_robot.position_m() - from_m;
    const double length_m = std::max(vector_m.norm(), 1e-9);
    const double along_m = std::clamp((robot_m - from_m).dot(vector_m) / length_m, 0.0, length_m);
    const double off_m = (robot_m - from_m - along_m / length_m * vector_m).norm();
    if (off_m >= best_m - 1e-9) continue;
    best_m = off_m;
    best = i;
    best_along_m = along_m;
  }
  segment_ = best;
  off_m_ = best_m;
  const planning::PathSample& sample = path_[best];
  progress_m_ = std::max(progress_m_, sample.distance_m + best_along_m);
  Place place;
  place.curvature_per_m = sample.curvature_per_m;
  place.heading_rad = sample.T_map_robot.theta_rad + sample.curvature_per_m * best_along_m;
  const auto half =
      geometry::sincos(sample.T_map_robot.theta_rad + 0.5 * sample.curvature_per_m * best_along_m);
  place.position_m =
      sample.T_map_robot.position_m() + best_along_m * Eigen::Vector2d(half.cos, half.sin);
  const auto along = geometry::sincos(place.heading_rad);
  const Eigen::Vector2d off = robot_m - place.position_m;
  place.left_m = along.cos * off.y() - along.sin * off.x();
  place.to_go_m = path_[leg_end_].distance_m - (sample.distance_m + best_along_m);
  if (best + 1 == leg_end_) {  // beyond the end it is negative
    const Eigen::Vector2d rest_m = path_[leg_end_].T_map_robot.position_m() - robot_m;
    place.to_go_m = rest_m.x() * along.cos + rest_m.y() * along.sin;
  }
  return place;
}

// The speed that the curves within the next metre allow.
double PathFollower::curve_speed(double to_go_m) const {
  constexpr double kAhead_m = 1.0;
  constexpr double kSideways_m_per_s2 = 0.6;  // limit of a light load
  constexpr double kTurnShare = 0.8;          // the rest is for corrections
  const double brake = kBrake * config_.acceleration_m_per_s2;
  double speed = std::min(config_.speed_m_per_s, stopping_speed(to_go_m, 0.0, brake));
  for (std::size_t i = segment_; i < leg_end_; ++i) {
    const double ahead_m = std::max(0.0, path_[i].distance_m - progress_m_);
    if (ahead_m > kAhead_m) break;
    const double curvature = std::fabs(path_[i].curvature_per_m);
    if (curvature < 1e-3) continue;
    const double here = std::min(kTurnShare * config_.turn_rad_per_s / curvature,
                                 std::sqrt(kSideways_m_per_s2 / curvature));
    speed = std::min(speed, std::sqrt(here * here + 2.0 * brake * ahead_m));
  }
  return speed;
}

double PathFollower::mean_curvature_per_m() const {
  double sum = 0.0;
  double length_m = 0.0;
  for (std::size_t i = leg_begin_; i < leg_end_; ++i) {
    const double on_m = std::min(path_[i + 1].distance_m, progress_m_ + kSteers_m) -
                        std::max(path_[i].distance_m, progress_m_ - kSteers_m);
    if (on_m <= 0.0) continue;
    sum += on_m * path_[i].curvature_per_m;
    length_m += on_m;
  }
  return length_m > 0.0 ? sum / length_m : path_[segment_].curvature_per_m;
}

double PathFollower::steering_speed() const {
  constexpr double kAhead_m = 1.0;
  constexpr double kShare = 0.8;  // the rest is for corrections
  double speed = config_.speed_m_per_s;
  for (std::size_t i = leg_begin_ + 1; i < leg_end_; ++i) {
    const double ahead_m = path_[i].distance_m - progress_m_;
    if (ahead_m < -kSteers_m) continue;
    if (ahead_m > kAhead_m) break;
    const double change = std::fabs(path_[i].curvature_per_m - path_[i - 1].curvature_per_m);
    if (change < 1e-3) continue;
    const double here =
        kShare * std::sqrt(2.0 * config_.turn_acceleration_rad_per_s2 * kSteers_m / change);
    const double until_m = std::max(0.0, ahead_m - kSteers_m);
    speed = std::min(
        speed, std::sqrt(here * here + 2.0 * kBrake * config_.acceleration_m_per_s2 * until_m));
  }
  return speed;
}

geometry::Velocity PathFollower::turn(double error_rad) const {
  const double most = std::min(
      config_.turn_rad_per_s,
      stopping_speed(std::fabs(error_rad), 0.0, kTurnBrake * config_.turn_acceleration_rad_per_s2));
  const double speed = std::max(most, kSlowest_rad_s);
  return {0.0, error_rad > 0.0 ? speed : -speed};
}

geometry::Velocity PathFollower::advance(const geometry::Pose2& T_map_robot, const Place& place,
                                         double limit_m_per_s) const {
  constexpr double kSteepest_rad = 0.7;
  constexpr double kSteepestAtEnd_rad = 0.3;
  const double heading_error_rad = geometry::wrap_angle(T_map_robot.theta_rad - place.heading_rad);
  const double steepest = place.to_go_m < kSettle_m ? kSteepestAtEnd_rad : kSteepest_rad;
  const double back_rad = std::clamp(-place.left_m / (2.0 * kSettle_m), -steepest, steepest);
  const double along = steers() ? mean_curvature_per_m() : place.curvature_per_m;
  double curvature = along + 2.0 / kSettle_m * (back_rad - heading_error_rad);
  double speed = std::min({limit_m_per_s, config_.speed_m_per_s, curve_speed(place.to_go_m)});
  if (steers()) {
    const double most = 1.0 / config_.minimum_radius_m;
    curvature = std::clamp(curvature, -most, most);
    speed = std::min(speed, steering_speed());
  }
  speed *= std::max(0.1, 1.0 - std::fabs(heading_error_rad) / kLost_rad);
  speed = std::max(speed, std::min(kSlowest_m_s, limit_m_per_s));
  if (std::fabs(curvature) * speed > config_.turn_rad_per_s) {
    speed = config_.turn_rad_per_s / std::fabs(curvature);
  }
  return {speed, speed * curvature};
}

void PathFollower::finish_turn(double heading_rad) {
  if (!turn_from_rad_) return;
  const double turned_rad = geometry::wrap_angle(heading_rad - *turn_from_rad_);
  turn_from_rad_.reset();
  if (std::fabs(turned_rad) < kCorner_rad) return;
  finished_.push_back(
      {turned_rad > 0.0 ? planning::MotionKind::kTurnLeft : planning::MotionKind::kTurnRight,
       std::fabs(turned_rad)});
}

void PathFollower::finish_leg(const Eigen::Vector2d& at_m) {
  if (leg_from_m_) {
    const double advance_m = (at_m - *leg_from_m_).norm();
    // There is no primitive for a leg back.
    if (advance_m > 1e-3 && !backs_up())
      finished_.push_back({planning::MotionKind::kAdvance, advance_m});
  }
  leg_from_m_.reset();
  if (leg_end_ + 1 < path_.size()) {
    begin_leg(leg_end_);
  } else {
    progress_m_ = path_.back().distance_m;
    phase_ = Phase::kFinalTurn;
  }
}

bool PathFollower::backs_up() const {
  return !path_.empty() && phase_ != Phase::kFinalTurn && path_[leg_begin_].backward;
}

// A leg back is one ahead of a robot that faces the other way.
geometry::Velocity PathFollower::control_either_way(const geometry::Pose2& T_map_robot,
                                                    double limit_m_per_s) {
  if (!backs_up()) return control(T_map_robot, limit_m_per_s);
  geometry::Pose2 reversed = T_map_robot;
  reversed.theta_rad = geometry::wrap_angle(T_map_robot.theta_rad + std::numbers::pi);
  geometry::Velocity velocity = control(reversed, limit_m_per_s);
  velocity.linear_m_per_s = -velocity.linear_m_per_s;
  return velocity;
}

geometry::Velocity PathFollower::control(const geometry::Pose2& T_map_robot, double limit_m_per_s) {
  if (phase_ == Phase::kTurn && steers()) {
    leg_from_m_ = T_map_robot.position_m();
    phase_ = Phase::kAdvance;
  }
  if (phase_ == Phase::kTurn) {
    const Place place = locate(T_map_robot);
    const double error_rad = geometry::wrap_angle(place.heading_rad - T_map_robot.theta_rad);
    const bool turning = turn_from_rad_.has_value();
    const double enough_rad =
        turning || leg_begin_ > 0 ? std::max(config_.arrival_rad, 0.05) : config_.begin_turn_rad;
    if (std::fabs(error_rad) > enough_rad) {
      if (!turning) turn_from_rad_ = T_map_robot.theta_rad;
      return turn(error_rad);
    }
    finish_turn(T_map_robot.theta_rad);
    leg_from_m_ = T_map_robot.position_m();
    phase_ = Phase::kAdvance;
  }
  if (phase_ == Phase::kAdvance) {
    const Place place = locate(T_map_robot);
    constexpr double kStopsAt = 0.3;  // of the arrival distance
    if (place.to_go_m <= kStopsAt * config_.arrival_m) {
      finish_leg(T_map_robot.position_m());
      return {};
    }
    const double error_rad = geometry::wrap_angle(place.heading_rad - T_map_robot.theta_rad);
    if (std::fabs(error_rad) < kLost_rad) return advance(T_map_robot, place, limit_m_per_s);
    strayed_ = steers();
    if (strayed_) return {};
    phase_ = Phase::kTurn;
    turn_from_rad_ = T_map_robot.theta_rad;
    return turn(error_rad);
  }
  if (phase_ == Phase::kFinalTurn) {
    const double error_rad = final_heading_rad_
                                 ? geometry::wrap_angle(*final_heading_rad_ - T_map_robot.theta_rad)
                                 : 0.0;
    if (!steers() && std::fabs(error_rad) > 0.5 * config_.arrival_rad) {
      if (!turn_from_rad_) turn_from_rad_ = T_map_robot.theta_rad;
      return turn(error_rad);
    }
    finish_turn(T_map_robot.theta_rad);
    if (commands_.stands()) phase_ = Phase::kDone;
  }
  return {};
}

geometry::Velocity PathFollower::ramped(const geometry::Velocity& wanted,
                                        std::int64_t now_ns) const {
  constexpr double kLongest_s = 0.2;
  constexpr double kDown = 1.5;      // ratio of braking to speeding up
  constexpr double kUsual_s = 0.05;  // between two steps, assumed for the first
  const geometry::Velocity last = commands_.last();
  const double time_s = std::clamp(commands_.since_last_s(now_ns, kUsual_s), 0.0, kLongest_s);
  const double up = config_.acceleration_m_per_s2 * time_s;
  const double turn = config_.turn_acceleration_rad_per_s2 * time_s;
  const geometry::Velocity next{
      std::clamp(wanted.linear_m_per_s, last.linear_m_per_s - kDown * up, last.linear_m_per_s + up),
      std::clamp(wanted.angular_rad_per_s, last.angular_rad_per_s - turn,
                 last.angular_rad_per_s + turn)};
  return geometry::drivable(next, config_.minimum_radius_m);
}

FollowerStep PathFollower::step(const geometry::Pose2& T_map_robot, std::int64_t now_ns,
                                double speed_limit_m_per_s) {
  FollowerStep result;
  if (!active_) return result;
  const geometry::Velocity wanted = control_either_way(commands_.predicted(T_map_robot, now_ns),
                                                       std::max(0.0, speed_limit_m_per_s));
  result.command = ramped(wanted, now_ns);
  result.done = phase_ == Phase::kDone;
  result.strayed = strayed_;
  result.rest_m = rest_m();
  result.off_m = off_m_;
  result.rest_s = rest_s();
  return result;
}

}  // namespace topogeo::navigation
