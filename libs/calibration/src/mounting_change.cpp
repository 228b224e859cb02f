#include "topogeo/calibration/mounting_change.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "mounting_fit.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

// No stretch as long decides for a wrong heading or side (docs/decisions/unknown_mounting.md).
constexpr std::size_t kStretch = 16;  // motions
constexpr std::size_t kStretchStep = kStretch / 2;

struct Stretch {
  FoundMounting mounting;
  std::int64_t first_ns = 0;
};

std::vector<Stretch> decided_stretches(std::span<const LaserMotion> motions) {
  std::vector<Stretch> stretches;
  for (std::size_t first = 0; first + kStretch <= motions.size(); first += kStretchStep) {
    const FoundMounting found = find_mounting(motions.subspan(first, kStretch));
    if (!found.heading_known) continue;
    stretches.push_back({found, motions[first].first_ns});
  }
  return stretches;
}

/// Whether more than half of the motions of any stretch are outliers of a mounting.
bool contradicts_any(std::span<const LaserMotion> motions, const Pose2& T_robot_laser) {
  const MountingFit fit = evaluated(motions, T_robot_laser);
  std::size_t outliers = 0;  // of the last kStretch motions
  const auto outlying = [&](std::size_t i) {
    return fit.squared_mahalanobis[i] > MountingFit::kOutlying ? 1U : 0U;
  };
  for (std::size_t i = 0; i < motions.size(); ++i) {
    outliers += outlying(i);
    if (i >= kStretch) outliers -= outlying(i - kStretch);
    if (outliers > kStretch / 2) return true;
  }
  return false;
}

bool agree(const Stretch& a, const Stretch& b) {
  const double apart_rad = a.mounting.T_robot_laser.theta_rad - b.mounting.T_robot_laser.theta_rad;
  return a.mounting.upside_down == b.mounting.upside_down &&
         std::fabs(geometry::wrap_angle(apart_rad)) < FoundMounting::kOtherHeading_rad;
}

/// Whether odometry turns between two stretches as the mounting seems to, in a motion over which
/// the scans do not: then it is the heading of the odometry that begins anew.
bool odometry_turns(std::span<const LaserMotion> motions, const Stretch& before,
                    const Stretch& after) {
  constexpr double kSameTurn_rad = 0.2;
  if (before.mounting.upside_down != after.mounting.upside_down) return false;
  const double change_rad =
      after.mounting.T_robot_laser.theta_rad - before.mounting.T_robot_laser.theta_rad;
  const std::int64_t last_ns = after.first_ns + (after.first_ns - before.first_ns);
  return std::ranges::any_of(motions, [&](const LaserMotion& motion) {
    if (motion.last_ns < before.first_ns || motion.first_ns > last_ns) return false;
    const double apart_rad = motion.T_odometry.theta_rad - motion.T_laser.theta_rad;
    return std::fabs(geometry::wrap_angle(apart_rad + change_rad)) < kSameTurn_rad;
  });
}

}  // namespace

std::optional<MountingChange> find_mounting_change(std::span<const LaserMotion> motions,
                                                   const FoundMounting& found) {
  // Straight stretches, which do not show the side, have that of the whole drive.
  std::vector<LaserMotion> seen(motions.begin(), motions.end());
  if (found.upside_down) std::ranges::transform(seen, seen.begin(), mirrored);
  if (!contradicts_any(seen, found.T_robot_laser)) return std::nullopt;
  std::vector<Stretch> stretches = decided_stretches(seen);
  for (Stretch& stretch : stretches) {
    stretch.mounting.upside_down = stretch.mounting.upside_down != found.upside_down;
  }
  for (std::size_t i = 2; i + 1 < stretches.size(); ++i) {
    const Stretch& before = stretches[i - 1];
    const Stretch& after = stretches[i];
    if (agree(before, after) || !agree(stretches[i - 2], before)) continue;
    if (!agree(after, stretches[i + 1]) || odometry_turns(seen, before, after)) continue;
    return MountingChange{before.mounting, after.mounting, after.first_ns};
  }
  return std::nullopt;
}

}  // namespace topogeo::localization
