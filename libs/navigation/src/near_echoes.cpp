#include "near_echoes.hpp"

#include <cmath>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/scan/scan.hpp"

#include "elapsed.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kNearRoom_m = 0.10;           // to be kept
constexpr double kOneEcho_m = 0.15;            // closer echoes belong to one object
constexpr double kNearKept_s = 4.0;            // until another sonar of a turning robot hears it
constexpr double kNearCurvePerMetre = 0.8;     // shifts a followed path by a decimetre
constexpr double kNearStepPerSecond_m = 0.05;  // while it turns on the spot

bool lies_along(const Eigen::Vector2d& point_m) {
  constexpr double kAlong = 0.35;  // within 70 degrees of ahead or back
  return std::fabs(point_m.x()) > kAlong * point_m.norm();
}

bool lies_beside(const Eigen::Vector2d& point_m) {
  constexpr double kBeside = 0.7;  // within 45 degrees of left or right
  return std::fabs(point_m.y()) > kBeside * point_m.norm();
}

bool turns_on_spot(const geometry::Velocity& wanted) {
  constexpr double kCreeping = 0.03;
  return std::fabs(wanted.linear_m_per_s) < kCreeping && wanted.angular_rad_per_s != 0.0;
}

}  // namespace

void NearEchoes::add(const SonarRound& sonar) {
  if (!odometry_) return;
  std::erase_if(near_, [&](const Near& near) {
    return elapsed_s(near.heard_ns, sonar.stamp_ns) > kNearKept_s;
  });
  for (const SonarReading& reading : sonar.readings) {
    if (reading.range_m == scan::Scan::kNoReturn) continue;
    if (static_cast<double>(reading.range_m) > config_.sonar_least_m) {
      forget_before(reading);
    } else {
      note(reading, sonar.stamp_ns);
    }
  }
}

// A longer echo of this reading proves that nearer objects in its cone are gone.
void NearEchoes::forget_before(const SonarReading& reading) {
  const geometry::Pose2 T_sonar_odom = inverse(odometry_->T_odom_robot * reading.T_robot_sonar);
  std::erase_if(near_, [&](const Near& near) {
    const Eigen::Vector2d seen_m = T_sonar_odom * near.point_m;
    return seen_m.x() > 0.0 &&
           std::fabs(geometry::atan2(seen_m.y(), seen_m.x())) < reading.half_cone_rad &&
           seen_m.norm() < static_cast<double>(reading.range_m) - kOneEcho_m;
  });
}

// The object may be anywhere between the body and the least range: assumes the middle.
void NearEchoes::note(const SonarReading& reading, std::int64_t heard_ns) {
  const Eigen::Vector2d least_m =
      reading.T_robot_sonar * Eigen::Vector2d(static_cast<double>(reading.range_m), 0.0);
  const double away_m = 0.5 * (least_m.norm() + config_.radius_m);
  const Eigen::Vector2d point_m = odometry_->T_odom_robot * (away_m * least_m.normalized());
  std::erase_if(near_,
                [&](const Near& near) { return (near.point_m - point_m).norm() < kOneEcho_m; });
  near_.push_back({point_m, heard_ns});
}

geometry::Velocity NearEchoes::make_room(const geometry::Velocity& wanted,
                                         std::int64_t now_ns) const {
  if (config_.needs_scan || !odometry_) return wanted;
  const geometry::Pose2 T_robot_odom = inverse(odometry_->T_odom_robot);
  bool left = false;
  bool right = false;
  bool ahead = false;
  bool behind = false;
  for (const Near& near : near_) {
    const Eigen::Vector2d point_m = T_robot_odom * near.point_m;
    const bool far = point_m.norm() > config_.radius_m + kNearRoom_m;
    if (far || elapsed_s(near.heard_ns, now_ns) > kNearKept_s) continue;
    if (lies_beside(point_m)) (point_m.y() > 0.0 ? left : right) = true;
    if (lies_along(point_m)) (point_m.x() > 0.0 ? ahead : behind) = true;
  }
  geometry::Velocity velocity = wanted;
  if (turns_on_spot(wanted)) {
    if (ahead != behind)
      velocity.linear_m_per_s = ahead ? -kNearStepPerSecond_m : kNearStepPerSecond_m;
  } else if (left != right && wanted.linear_m_per_s > 0.0) {
    velocity.angular_rad_per_s += (left ? -1.0 : 1.0) * kNearCurvePerMetre * wanted.linear_m_per_s;
  }
  return velocity;
}

}  // namespace topogeo::navigation
