#include "topogeo/simulation/noisier_odometry.hpp"

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace topogeo::simulation {
namespace {

using geometry::Pose2;

Pose2 from(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), geometry::wrap_angle(v.z())};
}

// Motion between two scans as a distance; a turn counts a little, so that a turn on the spot is not
// zero.
double effort_m(const Pose2& step) {
  constexpr double kPerRadian_m = 0.01;
  return step.position_m().norm() + kPerRadian_m * std::fabs(step.theta_rad);
}

// True steps between successive scans, for two scans with known true poses.
void fill_steps(std::span<const Pose2> T_odom_robot, std::size_t first, std::size_t last,
                const Pose2& T_first_last, std::vector<std::optional<Pose2>>& steps) {
  double whole_m = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    whole_m += effort_m(geometry::between(T_odom_robot[i], T_odom_robot[i + 1]));
  }
  const Pose2 by_odometry = geometry::between(T_odom_robot[first], T_odom_robot[last]);
  const Eigen::Vector3d gap = geometry::difference(T_first_last, by_odometry);
  const auto place = [&](std::size_t scan, double so_far_m) {
    const double share =
        whole_m > 0.0 ? so_far_m / whole_m
                      : static_cast<double>(scan - first) / static_cast<double>(last - first);
    const Pose2 odometry = geometry::between(T_odom_robot[first], T_odom_robot[scan]);
    return from(geometry::difference(odometry, {}) + share * gap);
  };
  Pose2 before;
  double so_far_m = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    so_far_m += effort_m(geometry::between(T_odom_robot[i], T_odom_robot[i + 1]));
    const Pose2 after = i + 1 == last ? T_first_last : place(i + 1, so_far_m);
    steps[i] = geometry::between(before, after);
    before = after;
  }
}

}  // namespace

std::vector<Pose2> noisier_odometry(std::span<const Pose2> T_odom_robot,
                                    std::span<const std::optional<Pose2>> T_world_robot,
                                    double factor) {
  if (T_odom_robot.size() != T_world_robot.size()) {
    throw std::invalid_argument("T_world_robot: expected one entry for each of the " +
                                std::to_string(T_odom_robot.size()) + " odometry poses, got " +
                                std::to_string(T_world_robot.size()));
  }
  if (!(factor >= 0.0 && factor <= 100.0)) {
    throw std::invalid_argument("factor: expected a number in [0, 100], got " +
                                std::to_string(factor));
  }
  std::vector<std::optional<Pose2>> true_steps(T_odom_robot.size());
  std::optional<std::size_t> known;
  std::size_t number = 0;
  for (std::size_t i = 0; i < T_world_robot.size(); ++i) {
    if (!T_world_robot[i]) continue;
    ++number;
    if (known) {
      fill_steps(T_odom_robot, *known, i,
                 geometry::between(*T_world_robot[*known], *T_world_robot[i]), true_steps);
    }
    known = i;
  }
  if (number < 2) {
    throw std::invalid_argument("T_world_robot: expected two known poses or more, got " +
                                std::to_string(number));
  }
  std::vector<Pose2> noisier{T_odom_robot.front()};
  for (std::size_t i = 0; i + 1 < T_odom_robot.size(); ++i) {
    const Pose2 step = geometry::between(T_odom_robot[i], T_odom_robot[i + 1]);
    const Pose2 truth = true_steps[i].value_or(step);
    const Eigen::Vector3d error = geometry::difference(step, truth);
    noisier.push_back(noisier.back() * from(geometry::difference(truth, {}) + factor * error));
  }
  return noisier;
}

}  // namespace topogeo::simulation
