#include "topogeo/simulation/drive.hpp"

#include <optional>
#include <stdexcept>

namespace topogeo::simulation {
namespace {

// 50 commands a second, like the motor controllers of small robots.
constexpr std::int64_t kTick_ns = 20'000'000;
constexpr double kTick_s = 0.02;

}  // namespace

std::vector<TimedPose> drive(const std::vector<Eigen::Vector2d>& tour_m,
                             const DriveOptions& options) {
  TourFollower follower(tour_m, options);
  const double limit_s = 10.0 + 20.0 * follower.rest_m() / options.speed_m_per_s;
  geometry::Pose2 pose = follower.start();
  std::vector<TimedPose> poses{{0, pose}};
  while (const std::optional<Velocity> velocity = follower.next(pose, kTick_s)) {
    if (static_cast<double>(poses.size()) * kTick_s > limit_s) {
      throw std::runtime_error(
          "drive: the end of the tour is not reached; lookahead_m or "
          "speed_m_per_s is too large for it");
    }
    pose = pose * geometry::Pose2{velocity->linear_m_per_s * kTick_s, 0.0,
                                  velocity->angular_rad_per_s * kTick_s};
    poses.push_back({static_cast<std::int64_t>(poses.size()) * kTick_ns, pose});
  }
  return poses;
}

}  // namespace topogeo::simulation
