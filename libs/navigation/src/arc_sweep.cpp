#include "topogeo/navigation/arc_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kStill_m_s = 1e-6;          // slower is no motion ahead or back
constexpr double kStraightCurvature = 1e-4;  // a circle of 10 km: rounding errors grow beyond it

double arc_cosine(double cosine) {
  return geometry::atan2(std::sqrt(std::max(0.0, 1.0 - cosine * cosine)), cosine);
}

// Ahead along x; callers mirror the point for motion back.
double straight_length_m(const Eigen::Vector2d& point_m, double radius_m) {
  if (std::fabs(point_m.y()) >= radius_m || point_m.x() <= 0.0) return HUGE_VAL;
  const double half_chord_m = std::sqrt(radius_m * radius_m - point_m.y() * point_m.y());
  return std::max(0.0, point_m.x() - half_chord_m);
}

// Ahead on a circle to the left of this radius.
double arc_length_m(const Eigen::Vector2d& point_m, double radius_m, double turning_m) {
  const Eigen::Vector2d seen_m(point_m.x(), point_m.y() - turning_m);
  const double off_m = seen_m.norm();
  if (std::fabs(off_m - turning_m) >= radius_m || off_m < 1e-9) return HUGE_VAL;
  // Angle from the start, which is at -90 degrees around the middle of the circle.
  double angle_rad = geometry::atan2(seen_m.y(), seen_m.x()) + 0.5 * std::numbers::pi;
  if (point_m.norm() < radius_m) return point_m.x() > 0.0 ? 0.0 : HUGE_VAL;
  if (angle_rad < 0.0) angle_rad += 2.0 * std::numbers::pi;
  const double cosine =
      (off_m * off_m + turning_m * turning_m - radius_m * radius_m) / (2.0 * off_m * turning_m);
  if (cosine <= -1.0) return 0.0;
  return std::max(0.0, angle_rad - arc_cosine(std::min(1.0, cosine))) * turning_m;
}

}  // namespace

SweptArc sweep(const geometry::Velocity& motion, std::span<const Eigen::Vector2d> points_m,
               double radius_m, double limit_m) {
  SweptArc arc{limit_m, std::nullopt};
  if (std::fabs(motion.linear_m_per_s) < kStill_m_s) return arc;
  const double ahead = motion.linear_m_per_s > 0.0 ? 1.0 : -1.0;
  // Curvature of the path: positive to the left of the direction of travel.
  const double curvature = ahead * motion.angular_rad_per_s / std::fabs(motion.linear_m_per_s);
  const double left = curvature >= 0.0 ? 1.0 : -1.0;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const Eigen::Vector2d point_m(ahead * points_m[i].x(), left * points_m[i].y());
    const double to_m = std::fabs(curvature) < kStraightCurvature
                            ? straight_length_m(point_m, radius_m)
                            : arc_length_m(point_m, radius_m, 1.0 / std::fabs(curvature));
    if (to_m < arc.length_m) arc = {to_m, i};
  }
  return arc;
}

double stopping_speed(double distance_m, double delay_s, double brake_m_per_s2) {
  if (distance_m <= 0.0) return 0.0;
  const double delayed = brake_m_per_s2 * delay_s;
  return std::sqrt(delayed * delayed + 2.0 * brake_m_per_s2 * distance_m) - delayed;
}

geometry::Pose2 moved(const geometry::Velocity& velocity, double time_s) {
  const double turn_rad = velocity.angular_rad_per_s * time_s;
  const double arc_m = velocity.linear_m_per_s * time_s;
  const auto half = geometry::sincos(0.5 * turn_rad);
  // The chord of the arc.
  const double chord_m = std::fabs(turn_rad) < 1e-9 ? arc_m : arc_m * half.sin / (0.5 * turn_rad);
  return {chord_m * half.cos, chord_m * half.sin, geometry::wrap_angle(turn_rad)};
}

}  // namespace topogeo::navigation
