#include "topogeo/calibration/mounting_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "topogeo/calibration/laser_calibration.hpp"

#include "mounting_fit.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using Motions = std::vector<LaserMotion>;

constexpr double kDegree = std::numbers::pi / 180.0;
// The least squares of the heading starts from the nearest of these.
constexpr int kHeadings = 72;
// A motion contradicts a mounting if it is an outlier there, and that much less likely.
constexpr double kContradicts = MountingFit::kOutlying;
// Plates and brackets are made square. A heading this near a right angle that the scans do not
// distinguish from it is that right angle.
constexpr double kSquare_rad = 3.0 * kDegree;
constexpr double kSquareSpreads = 2.0;
// Odometry that lags behind the scans or drifts to one side looks like another mounting, in every
// motion alike (docs/decisions/unknown_mounting.md).
constexpr double kSystematic_m = 0.04;
constexpr double kSystematic_rad = 1.0 * kDegree;
// Motions must explain themselves: with more outliers, odometry or matches are useless.
constexpr double kLeastFitting = 0.5;

std::vector<MountingFit> fits_all_around(const Motions& motions) {
  std::vector<MountingFit> fits;
  fits.reserve(kHeadings);
  for (int k = 0; k < kHeadings; ++k) {
    fits.push_back(fit_position(motions, geometry::wrap_angle(k * 360.0 / kHeadings * kDegree)));
  }
  return fits;
}

const MountingFit& best_of(const std::vector<MountingFit>& fits) {
  return *std::ranges::min_element(fits, {}, &MountingFit::cost);
}

/// The best fit whose heading differs from `yaw_rad` by at least FoundMounting::kOtherHeading_rad.
const MountingFit& rival_of(const std::vector<MountingFit>& fits, double yaw_rad) {
  const MountingFit* best = nullptr;
  for (const MountingFit& fit : fits) {
    const double apart_rad = geometry::wrap_angle(fit.T_robot_laser.theta_rad - yaw_rad);
    if (std::fabs(apart_rad) < FoundMounting::kOtherHeading_rad - 1e-9) continue;
    if (best == nullptr || fit.cost < best->cost) best = &fit;
  }
  return *best;
}

MountingVotes vote(const MountingFit& fit, const MountingFit& rival) {
  MountingVotes votes;
  for (std::size_t i = 0; i < fit.squared_mahalanobis.size(); ++i) {
    const double here = fit.squared_mahalanobis[i];
    const double there = rival.squared_mahalanobis[i];
    if (here <= MountingFit::kOutlying && there - here > kContradicts) ++votes.for_it;
    if (there <= MountingFit::kOutlying && here - there > kContradicts) ++votes.against;
  }
  return votes;
}

std::size_t fitting(const MountingFit& fit) {
  return static_cast<std::size_t>(std::ranges::count_if(
      fit.squared_mahalanobis, [](double d2) { return d2 <= MountingFit::kOutlying; }));
}

double squared_off(double yaw_rad, double spread_rad) {
  constexpr double kRight = 90.0 * kDegree;
  const double square_rad = geometry::wrap_angle(std::round(yaw_rad / kRight) * kRight);
  const double off_rad = std::fabs(geometry::wrap_angle(yaw_rad - square_rad));
  return off_rad <= std::min(kSquare_rad, kSquareSpreads * spread_rad) ? square_rad : yaw_rad;
}

void refine(const Motions& motions, FoundMounting& found) {
  const MountingFit fit = fit_mounting(motions, found.T_robot_laser);
  const Eigen::Vector3d spread = fit.covariance.diagonal().cwiseSqrt();
  const double scatter_m = std::max(spread.x(), spread.y());
  found.heading_spread_rad = std::hypot(spread.z(), kSystematic_rad);
  found.position_spread_m = std::hypot(scatter_m, kSystematic_m);
  found.T_robot_laser = {0.0, 0.0,
                         squared_off(fit.T_robot_laser.theta_rad, found.heading_spread_rad)};
  found.position_known = scatter_m <= kLargestMountingSpread_m;
  if (!found.position_known) return;
  found.T_robot_laser.x_m = fit.T_robot_laser.x_m;
  found.T_robot_laser.y_m = fit.T_robot_laser.y_m;
}

}  // namespace

double MountingVotes::confidence() const {
  return (static_cast<double>(for_it) + 1.0) / (static_cast<double>(for_it + against) + 2.0);
}

bool MountingVotes::decided() const {
  return for_it >= kFewest && for_it >= 4 * against;
}

double FoundMounting::confidence() const {
  if (!heading_known) return 0.0;
  return side.decided() ? std::min(heading.confidence(), side.confidence()) : heading.confidence();
}

FoundMounting find_mounting(std::span<const LaserMotion> motions) {
  FoundMounting found;
  found.motions = motions.size();
  if (motions.empty()) return found;
  Motions upright(motions.begin(), motions.end());
  Motions upside_down;
  upside_down.reserve(motions.size());
  for (const LaserMotion& motion : motions) upside_down.push_back(mirrored(motion));
  const std::vector<MountingFit> of_upright = fits_all_around(upright);
  const std::vector<MountingFit> of_upside_down = fits_all_around(upside_down);

  found.side = vote(best_of(of_upright), best_of(of_upside_down));
  const MountingVotes reversed{found.side.against, found.side.for_it};
  found.upside_down = reversed.decided();
  if (found.upside_down) found.side = reversed;
  const Motions& seen = found.upside_down ? upside_down : upright;
  const std::vector<MountingFit>& fits = found.upside_down ? of_upside_down : of_upright;

  const MountingFit& best = best_of(fits);
  found.fitting = fitting(best);
  found.heading = vote(best, rival_of(fits, best.T_robot_laser.theta_rad));
  found.heading_known =
      found.heading.decided() &&
      static_cast<double>(found.fitting) >= kLeastFitting * static_cast<double>(found.motions);
  if (!found.heading_known) return found;
  found.T_robot_laser = best.T_robot_laser;
  refine(seen, found);
  return found;
}

}  // namespace topogeo::localization
