#include "topogeo/simulation/drive.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::simulation {
namespace {

constexpr std::int64_t kTick_ns = 20'000'000;
constexpr double kTick_s = 0.02;
constexpr double kArrived_m = 0.05;

void check(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw std::invalid_argument(std::string(name) + ": expected a number in [" + std::to_string(low) +
                              ", " + std::to_string(high) + "], got " + std::to_string(value));
}

// The point that runs ahead of the robot.
class Carrot {
 public:
  explicit Carrot(const std::vector<Eigen::Vector2d>& path_m) : path_m_(path_m) {
    for (std::size_t i = 1; i < path_m.size(); ++i) rest_m_ += (path_m[i] - path_m[i - 1]).norm();
  }

  // Runs on until it is `lookahead_m` away from the robot or at the end.
  void run(const Eigen::Vector2d& robot_m, double lookahead_m) {
    constexpr double kStep_m = 0.01;
    while (next_ < path_m_.size() && (point_m() - robot_m).norm() < lookahead_m) {
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

  [[nodiscard]] Eigen::Vector2d point_m() const {
    if (next_ == path_m_.size()) return path_m_.back();
    const Eigen::Vector2d leg_m = path_m_[next_] - path_m_[next_ - 1];
    return path_m_[next_ - 1] + leg_m * (along_m_ / leg_m.norm());
  }
  [[nodiscard]] bool at_end() const { return next_ == path_m_.size(); }
  [[nodiscard]] double rest_m() const { return std::max(rest_m_, 0.0); }

 private:
  const std::vector<Eigen::Vector2d>& path_m_;
  std::size_t next_ = 1;
  double along_m_ = 0.0;
  double rest_m_ = 0.0;
};

// Speed that suits a heading error: full when aimed, none from 60 degrees on.
double share_of_speed(double heading_error_rad) {
  constexpr double kCosOfStop = 0.5;
  const double aim = geometry::sincos(heading_error_rad).cos;
  return std::clamp((aim - kCosOfStop) / (1.0 - kCosOfStop), 0.0, 1.0);
}

}  // namespace

std::vector<TimedPose> drive(const std::vector<Eigen::Vector2d>& tour_m,
                             const DriveOptions& options) {
  check("speed_m_per_s", options.speed_m_per_s, 0.01, 10.0);
  check("turn_rad_per_s", options.turn_rad_per_s, 0.01, 10.0);
  check("acceleration_m_per_s2", options.acceleration_m_per_s2, 0.01, 10.0);
  check("lookahead_m", options.lookahead_m, 0.05, 5.0);
  std::vector<Eigen::Vector2d> path_m;
  for (const Eigen::Vector2d& point_m : tour_m) {
    if (path_m.empty() || point_m != path_m.back()) path_m.push_back(point_m);
  }
  if (path_m.size() < 2) {
    throw std::invalid_argument("tour: expected two different way points or more, got " +
                                std::to_string(path_m.size()));
  }

  const Eigen::Vector2d start = path_m[1] - path_m[0];
  geometry::Pose2 pose{path_m[0].x(), path_m[0].y(), geometry::atan2(start.y(), start.x())};
  Carrot carrot(path_m);
  const double limit_s = 10.0 + 20.0 * carrot.rest_m() / options.speed_m_per_s;
  std::vector<TimedPose> poses{{0, pose}};
  double speed_m_per_s = 0.0;
  while (true) {
    carrot.run(pose.position_m(), options.lookahead_m);
    const Eigen::Vector2d to_carrot_m = carrot.point_m() - pose.position_m();
    const double rest_m = carrot.rest_m() + to_carrot_m.norm();
    if (carrot.at_end() && rest_m < kArrived_m) return poses;
    if (static_cast<double>(poses.size()) * kTick_s > limit_s) {
      throw std::runtime_error(
          "drive: the end of the tour is not reached; lookahead_m or "
          "speed_m_per_s is too large for it");
    }
    const double error_rad =
        geometry::wrap_angle(geometry::atan2(to_carrot_m.y(), to_carrot_m.x()) - pose.theta_rad);
    const double wanted_m_per_s =
        std::min(options.speed_m_per_s * share_of_speed(error_rad),
                 std::max(0.05, std::sqrt(2.0 * options.acceleration_m_per_s2 * rest_m) * 0.9));
    const double change = options.acceleration_m_per_s2 * kTick_s;
    // A turn stops the robot at once: braking on a curve would carry it off the path.
    speed_m_per_s = std::min(speed_m_per_s + change, wanted_m_per_s);
    constexpr double kTurnGain_per_s = 3.0;
    const double turn_rad_per_s =
        std::clamp(kTurnGain_per_s * error_rad, -options.turn_rad_per_s, options.turn_rad_per_s);
    pose = pose * geometry::Pose2{speed_m_per_s * kTick_s, 0.0, turn_rad_per_s * kTick_s};
    poses.push_back({static_cast<std::int64_t>(poses.size()) * kTick_ns, pose});
  }
}

}  // namespace topogeo::simulation
