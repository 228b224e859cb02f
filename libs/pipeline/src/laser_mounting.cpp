#include "topogeo/pipeline/laser_mounting.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "topogeo/support/config_schema.hpp"
#include "topogeo/support/format.hpp"

#include "pose_text.hpp"

namespace topogeo::pipeline {
namespace {

// Larger than the error of measuring a mounting with a rule.
constexpr double kContradicting_m = 0.02;
constexpr double kContradicting_rad = std::numbers::pi / 180.0;

std::string in_words(const geometry::Pose2& T_robot_laser) {
  return fmt::format("{:.3f} m ahead, {:.3f} m to the left, {:.1f} deg", T_robot_laser.x_m,
                     T_robot_laser.y_m, T_robot_laser.theta_rad * 180.0 / std::numbers::pi);
}

}  // namespace

void mount_laser(Config& config, const geometry::Pose2& T_robot_laser) {
  config.local_mapper.T_robot_laser = T_robot_laser;
  config.local_mapper.voronoi.forward_rad = -T_robot_laser.theta_rad;
}

std::string choose_mounting(LoadedConfig& config, const std::optional<geometry::Pose2>& in_log) {
  const geometry::Pose2 configured = config.config.local_mapper.T_robot_laser;
  if (!in_log || *in_log == configured) return {};
  if (config.laser_set) {
    const Eigen::Vector3d apart = difference(*in_log, configured);
    if (apart.head<2>().norm() <= kContradicting_m && std::fabs(apart.z()) <= kContradicting_rad) {
      return {};
    }
    return fmt::format("warning: laser {}: from the configuration, but the log states {}",
                       in_words(configured), in_words(*in_log));
  }
  mount_laser(config.config, *in_log);
  config.effective = support::effective(describe(config.config));
  return fmt::format("laser {}: from the log", in_words(*in_log));
}

std::string mounting_argument(const geometry::Pose2& T_robot_laser) {
  return fmt::format("{},{},{}", T_robot_laser.x_m, T_robot_laser.y_m, T_robot_laser.theta_rad);
}

geometry::Pose2 parse_mounting(const std::string& text) {
  const auto numbers = parse_three_numbers(text);
  if (!numbers) {
    throw std::invalid_argument("mounting '" + text + "': expected x,y,yaw in metres and radians");
  }
  LocalMapperConfig mounted;
  mounted.T_robot_laser = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
  support::check_ranges(mounted);
  return mounted.T_robot_laser;
}

}  // namespace topogeo::pipeline
