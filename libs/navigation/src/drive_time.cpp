#include "topogeo/navigation/drive_time.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/navigation/arc_sweep.hpp"
#include "topogeo/navigation/path_follower.hpp"

#include "path_band.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kMeanBrake = 0.6;             // of the acceleration, in the mean of a stop
constexpr double kMeanTurnBrake = 0.6;         // the same for turns
constexpr double kSharpCorner_rad = 0.9;       // sharper corners are turned on the spot
constexpr double kRounding_m = 0.4;            // length on which other corners are rounded
constexpr double kLeastTurn_rad = 0.02;        // less is no turn
constexpr double kLeastSpeed_m_s = 0.03;       // bases do not move slower
constexpr double kSidewaysAcceleration = 0.6;  // limit in curves
constexpr double kTurnShare = 0.8;             // of the turning speed in curves
constexpr double kArrival_s = 0.4;             // the robot comes to rest

double turn_time_s(double turn_rad, const FollowerConfig& config) {
  const double angle = std::fabs(turn_rad);
  if (angle < kLeastTurn_rad) return 0.0;
  const double up = config.turn_acceleration_rad_per_s2;
  const double down = kMeanTurnBrake * up;
  const double ramps = 0.5 * (1.0 / up + 1.0 / down);  // seconds per speed
  const double fastest = std::min(config.turn_rad_per_s, std::sqrt(angle / ramps));
  return angle / fastest + ramps * fastest + config.delay_s;
}

double fastest_at(const planning::PathSample& sample, double limit_m_per_s,
                  const FollowerConfig& config) {
  double speed = std::min(config.speed_m_per_s, limit_m_per_s);
  const double curvature = std::fabs(sample.curvature_per_m);
  if (curvature > 1e-3) {
    speed = std::min({speed, kTurnShare * config.turn_rad_per_s / curvature,
                      std::sqrt(kSidewaysAcceleration / curvature)});
  }
  return std::max(speed, std::min(kLeastSpeed_m_s, limit_m_per_s));
}

/// The path that the navigator makes of a route: it cuts corners, into slow zones too, and keeps
/// off walls.
std::vector<planning::PathSample> driven_path(std::span<const Eigen::Vector2d> points_m,
                                              const planning::FreeSpace* space,
                                              const NavigatorConfig& config) {
  const bool smooth = config.motion == MotionStyle::kSmooth && !plans_poses(config.guard);
  if (space != nullptr && smooth && points_m.size() > 1) {
    const auto banded_m = band(*space, points_m, {}, band_of(config.guard));
    if (!banded_m.empty()) return samples_of(banded_m, kSharpCorner_rad);
  }
  std::vector<planning::PathSample> path = straight_path(points_m);
  for (planning::PathSample& sample : path) {
    if (std::fabs(sample.turn_on_spot_rad) >= kSharpCorner_rad) continue;
    sample.curvature_per_m = sample.turn_on_spot_rad / kRounding_m;
    sample.turn_on_spot_rad = 0.0;
  }
  return path;
}

}  // namespace

std::vector<double> limits_along(const planning::FreeSpace& space,
                                 std::span<const planning::PathSample> path) {
  std::vector<double> limits(path.size(), std::numeric_limits<double>::infinity());
  if (!space.rules().guides()) return limits;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const auto cell = space.frame().cell_of(path[i].T_map_robot.position_m());
    const auto limit = cell ? space.rules().speed_mps(space.frame().index(*cell)) : std::nullopt;
    if (limit) limits[i] = *limit;
  }
  return limits;
}

std::vector<double> rest_times_s(std::span<const planning::PathSample> path,
                                 std::span<const double> limits_m_per_s,
                                 const FollowerConfig& config) {
  std::vector<double> rest_s(path.size(), 0.0);
  if (path.size() < 2) return rest_s;
  std::vector<double> speed(path.size(), 0.0);
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const bool stands = std::fabs(path[i].turn_on_spot_rad) > kLeastTurn_rad ||
                        path[i].backward != path[i - 1].backward;
    if (stands) continue;
    const double limit = limits_m_per_s.empty() ? config.speed_m_per_s : limits_m_per_s[i];
    speed[i] = fastest_at(path[i], limit, config);
  }
  const double up = config.acceleration_m_per_s2;
  const auto piece_m = [&](std::size_t i) { return path[i + 1].distance_m - path[i].distance_m; };
  const auto reached = [](double from, double acceleration, double length_m) {
    return std::sqrt(from * from + 2.0 * acceleration * length_m);
  };
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    speed[i + 1] = std::min(speed[i + 1], reached(speed[i], up, piece_m(i)));
  }
  for (std::size_t i = path.size() - 1; i-- > 0;) {
    speed[i] = std::min(speed[i], reached(speed[i + 1], kMeanBrake * up, piece_m(i)));
  }
  for (std::size_t i = path.size() - 1; i-- > 0;) {
    const double limit = limits_m_per_s.empty() ? config.speed_m_per_s : limits_m_per_s[i];
    const double fastest = std::min(config.speed_m_per_s, limit);
    double mean = 0.5 * (speed[i] + speed[i + 1]);
    // A piece between two stops has its own top speed.
    if (mean == 0.0) mean = 0.5 * std::min(fastest, reached(0.0, 0.5 * up, piece_m(i)));
    rest_s[i] = rest_s[i + 1] + piece_m(i) / std::max(mean, 0.5 * kLeastSpeed_m_s) +
                turn_time_s(path[i + 1].turn_on_spot_rad, config);
  }
  return rest_s;
}

double drive_time_s(std::span<const Eigen::Vector2d> points_m, std::optional<double> heading_rad,
                    const planning::FreeSpace* space, const NavigatorConfig& config) {
  const std::vector<planning::PathSample> path = driven_path(points_m, space, config);
  if (path.size() < 2) return 0.0;
  const FollowerConfig& follower = config.follower;
  double time_s = kArrival_s + follower.delay_s;
  if (heading_rad) {
    const double turn_rad = geometry::wrap_angle(path.front().T_map_robot.theta_rad - *heading_rad);
    if (std::fabs(turn_rad) > follower.begin_turn_rad) time_s += turn_time_s(turn_rad, follower);
  }
  std::vector<double> limits;
  if (space != nullptr) limits = limits_along(*space, path);
  return time_s + rest_times_s(path, limits, follower).front();
}

}  // namespace topogeo::navigation
