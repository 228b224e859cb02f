#include "laser_scan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include <Eigen/Core>

namespace topogeo::ros_bridge {
namespace {

constexpr float kNoEcho = 0.0F;
/// Two echoes side by side that are nearer than this are taken for one surface.
constexpr double kOneSurface_m = 0.2;

void require(bool good, const char* field, const std::string& expected) {
  if (!good) throw std::invalid_argument(std::string(field) + ": expected " + expected);
}

struct Echo {
  double angle_rad = 0.0;
  Eigen::Vector2d point_m = Eigen::Vector2d::Zero();
};

/// The distance at which a ray meets the line from `a` to `b`; empty where it does not.
std::optional<double> meet(double angle_rad, const Echo& a, const Echo& b) {
  const Eigen::Vector2d ray(std::cos(angle_rad), std::sin(angle_rad));
  const Eigen::Vector2d edge = b.point_m - a.point_m;
  const double denominator = ray.x() * edge.y() - ray.y() * edge.x();
  if (std::fabs(denominator) < 1e-12) return std::nullopt;
  const double range_m = (a.point_m.x() * edge.y() - a.point_m.y() * edge.x()) / denominator;
  return range_m > 0.0 ? std::optional(range_m) : std::nullopt;
}

/// Ranges of the beams of `pattern` from echoes anywhere.
std::vector<float> rebinned(std::vector<Echo> echoes, const BeamPattern& pattern) {
  std::ranges::sort(echoes, {}, &Echo::angle_rad);
  std::vector<float> ranges_m(pattern.beams, kNoEcho);
  const double reach_rad = 1.5 * pattern.angle_step_rad;
  std::size_t next = 0;
  for (std::size_t i = 0; i < pattern.beams; ++i) {
    const double angle_rad =
        pattern.angle_min_rad + static_cast<double>(i) * pattern.angle_step_rad;
    while (next < echoes.size() && echoes[next].angle_rad < angle_rad) ++next;
    const Echo* before = next > 0 ? &echoes[next - 1] : nullptr;
    const Echo* after = next < echoes.size() ? &echoes[next] : nullptr;
    if (before != nullptr && angle_rad - before->angle_rad > reach_rad) before = nullptr;
    if (after != nullptr && after->angle_rad - angle_rad > reach_rad) after = nullptr;
    if (before != nullptr && after != nullptr &&
        (before->point_m - after->point_m).norm() < kOneSurface_m) {
      if (const auto range_m = meet(angle_rad, *before, *after)) {
        ranges_m[i] = static_cast<float>(*range_m);
        continue;
      }
    }
    const double half_rad = 0.5 * pattern.angle_step_rad * (1.0 + 1e-6);
    const bool left = after != nullptr && after->angle_rad - angle_rad <= half_rad;
    const bool right = before != nullptr && angle_rad - before->angle_rad <= half_rad;
    if (left && (!right || after->angle_rad - angle_rad < angle_rad - before->angle_rad)) {
      ranges_m[i] = static_cast<float>(after->point_m.norm());
    } else if (right) {
      ranges_m[i] = static_cast<float>(before->point_m.norm());
    }
  }
  return ranges_m;
}

}  // namespace

Sweep to_sweep(const ros::LaserScan& message, bool upside_down) {
  const std::size_t beams = message.ranges_().size();
  require(beams > 1, "ranges", "at least two beams");
  const double step_rad = static_cast<double>(message.angle_increment_());
  const double first_rad = static_cast<double>(message.angle_min_());
  require(std::isfinite(step_rad) && step_rad != 0.0, "angle_increment", "a number other than 0");
  require(std::isfinite(first_rad), "angle_min", "a number");
  const double sweep_rad = std::fabs(step_rad) * static_cast<double>(beams - 1);
  constexpr double kOneTurn_rad = 2.0 * std::numbers::pi * 1.001;  // in single precision
  require(sweep_rad < kOneTurn_rad, "angle_increment", "at most one turn");
  const double time_step_s = static_cast<double>(message.time_increment_());
  require(std::isfinite(time_step_s) && time_step_s >= 0.0, "time_increment",
          "a number of at least 0");

  Sweep sweep;
  sweep.ranges_m.assign(message.ranges_().begin(), message.ranges_().end());
  for (float& range_m : sweep.ranges_m) {
    // Not with >= alone: no comparison holds for what is no number.
    const bool echo = range_m >= message.range_min_() && range_m <= message.range_max_() &&
                      std::isfinite(range_m) && range_m > 0.0F;
    if (!echo) range_m = kNoEcho;
  }
  const double last_rad = first_rad + step_rad * static_cast<double>(beams - 1);
  double low_rad = std::min(first_rad, last_rad);
  bool reversed = step_rad < 0.0;
  if (upside_down) {
    low_rad = -std::max(first_rad, last_rad);
    reversed = !reversed;
  }
  sweep.pattern = {low_rad, std::fabs(step_rad), beams};
  sweep.time_step_s = time_step_s;
  if (reversed) {
    std::ranges::reverse(sweep.ranges_m);
    sweep.first_beam_s = time_step_s * static_cast<double>(beams - 1);
    sweep.time_step_s = -time_step_s;
  }
  return sweep;
}

Sweep thinned(Sweep sweep, std::size_t most) {
  const std::size_t n = (sweep.ranges_m.size() + most - 1) / most;
  if (n <= 1) return sweep;
  std::vector<float> kept;
  for (std::size_t i = 0; i < sweep.ranges_m.size(); i += n) kept.push_back(sweep.ranges_m[i]);
  sweep.ranges_m = std::move(kept);
  sweep.pattern.beams = sweep.ranges_m.size();
  sweep.pattern.angle_step_rad *= static_cast<double>(n);
  sweep.time_step_s *= static_cast<double>(n);
  return sweep;
}

std::vector<float> on_pattern(const Sweep& sweep, const BeamPattern& pattern) {
  std::vector<float> ranges_m(pattern.beams, kNoEcho);
  const double reach_rad = 0.5 * std::max(sweep.pattern.angle_step_rad, pattern.angle_step_rad);
  for (std::size_t i = 0; i < pattern.beams; ++i) {
    const double angle_rad =
        pattern.angle_min_rad + static_cast<double>(i) * pattern.angle_step_rad;
    const double place = (angle_rad - sweep.pattern.angle_min_rad) / sweep.pattern.angle_step_rad;
    const double nearest = std::round(place);
    if (nearest < 0.0 || nearest >= static_cast<double>(sweep.ranges_m.size())) continue;
    if (std::fabs(place - nearest) * sweep.pattern.angle_step_rad > reach_rad * (1.0 + 1e-6))
      continue;
    ranges_m[i] = sweep.ranges_m[static_cast<std::size_t>(nearest)];
  }
  return ranges_m;
}

std::vector<float> deskewed(
    const Sweep& sweep,
    const std::function<std::optional<geometry::Pose2>(double)>& T_odom_laser_after) {
  const std::optional<geometry::Pose2> T_odom_start = T_odom_laser_after(0.0);
  if (!T_odom_start) return sweep.ranges_m;
  const double middle_rad =
      sweep.pattern.angle_min_rad +
      0.5 * sweep.pattern.angle_step_rad * static_cast<double>(sweep.pattern.beams - 1);
  std::vector<Echo> echoes;
  for (std::size_t i = 0; i < sweep.ranges_m.size(); ++i) {
    const auto range_m = static_cast<double>(sweep.ranges_m[i]);
    if (range_m <= 0.0) continue;
    const double angle_rad =
        sweep.pattern.angle_min_rad + static_cast<double>(i) * sweep.pattern.angle_step_rad;
    const double after_s = sweep.first_beam_s + static_cast<double>(i) * sweep.time_step_s;
    const auto T_odom_laser = T_odom_laser_after(after_s);
    Eigen::Vector2d point_m(range_m * std::cos(angle_rad), range_m * std::sin(angle_rad));
    if (T_odom_laser) point_m = geometry::between(*T_odom_start, *T_odom_laser) * point_m;
    // Near the middle of the pattern, so that a full turn has one place for each direction.
    const double seen_rad = std::atan2(point_m.y(), point_m.x());
    echoes.push_back({middle_rad + geometry::wrap_angle(seen_rad - middle_rad), point_m});
  }
  return rebinned(std::move(echoes), sweep.pattern);
}

}  // namespace topogeo::ros_bridge
