#include "outline_block.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace topogeo::navigation {
namespace {

constexpr double kPassesAt_m = 0.02;    // distance at which it passes obstacles
constexpr double kApproaches_m = 0.03;  // a larger approach blocks
constexpr double kTurnStep_rad = 0.07;  // of turns: about 5 cm at the corners of a long robot

struct Watched {
  Eigen::Vector2d point_m;
  double touch_m;
};

// A heading of the travel as that of the robot.
geometry::Pose2 robot_at(const planning::PathSample& sample) {
  geometry::Pose2 pose = sample.T_map_robot;
  if (sample.backward) pose.theta_rad = geometry::wrap_angle(pose.theta_rad + std::numbers::pi);
  return pose;
}

}  // namespace

std::optional<PathBlock> outline_block(const geometry::Footprint& footprint,
                                       std::span<const planning::PathSample> path, double from_m,
                                       const geometry::Pose2& T_map_robot,
                                       std::span<const Eigen::Vector2d> obstacles_m,
                                       double reach_m) {
  const double around_m = geometry::circumscribed_radius_m(footprint) + kPassesAt_m;
  const geometry::Pose2 T_robot_map = geometry::inverse(T_map_robot);
  std::vector<Watched> watched;
  for (const Eigen::Vector2d& obstacle_m : obstacles_m) {
    const double now_m = geometry::signed_distance_m(footprint, T_robot_map * obstacle_m);
    if (now_m > reach_m + 2.0 * around_m) continue;
    watched.push_back({obstacle_m, std::min(kPassesAt_m, now_m - kApproaches_m)});
  }
  const auto touched = [&](const geometry::Pose2& pose) {
    const geometry::Pose2 T_body_map = geometry::inverse(pose);
    return std::ranges::find_if(watched, [&](const Watched& w) {
      return (w.point_m - pose.position_m()).norm() < around_m &&
             geometry::signed_distance_m(footprint, T_body_map * w.point_m) < w.touch_m;
    });
  };
  for (const planning::PathSample& sample : path) {
    const double ahead_m = sample.distance_m - from_m;
    if (ahead_m < 0.0) continue;
    if (ahead_m > reach_m) break;
    const geometry::Pose2 there = robot_at(sample);
    const int steps = std::max(
        1, static_cast<int>(std::ceil(std::fabs(sample.turn_on_spot_rad) / kTurnStep_rad)));
    for (int k = steps - 1; k >= 0; --k) {
      geometry::Pose2 pose = there;
      pose.theta_rad -= sample.turn_on_spot_rad * k / steps;
      const auto contact = touched(pose);
      if (contact != watched.end()) return PathBlock{ahead_m, contact->point_m};
    }
  }
  return std::nullopt;
}

}  // namespace topogeo::navigation
