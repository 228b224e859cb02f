#include "topogeo/matching/expected_overlap.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::localization {

std::vector<SurfacePoint> outline_of(std::span<const SurfacePoint> coarse) {
  constexpr std::size_t kPoints = 40;
  const std::size_t stride = std::max<std::size_t>(1, coarse.size() / kPoints);
  std::vector<SurfacePoint> outline;
  for (std::size_t i = 0; i < coarse.size(); i += stride) outline.push_back(coarse[i]);
  return outline;
}

double expected_common(const RangeProfile& viewer, std::span<const SurfacePoint> outline,
                       const UncertainPose& T_viewer_outline) {
  if (outline.empty()) return 0.0;
  const Eigen::Matrix3d& covariance = T_viewer_outline.covariance;
  const double tolerance_m = 0.2 + std::sqrt(std::max(covariance(0, 0), covariance(1, 1)));
  double common = 0.0;
  const geometry::Pose2& T = T_viewer_outline.T_a_b;
  const geometry::SinCos r = geometry::sincos(T.theta_rad);
  for (const SurfacePoint& point : outline) {
    const SurfacePoint p = moved(point, T, r);
    if (viewer.view_of_face(p.position_m, p.normal, tolerance_m) == RangeProfile::View::kSurface) {
      common += 1.0;
    }
  }
  return common / static_cast<double>(outline.size());
}

double expected_overlap(const RangeProfile& viewer, std::span<const SurfacePoint> outline,
                        const UncertainPose& T_viewer_outline, double least) {
  if (outline.empty()) return 0.0;
  const Eigen::Matrix3d& covariance = T_viewer_outline.covariance;
  const double tolerance_m = 0.5 + 2.0 * std::sqrt(std::max(covariance(0, 0), covariance(1, 1)));
  const auto points = static_cast<double>(outline.size());
  double unseen = 0.0;
  const geometry::Pose2& T = T_viewer_outline.T_a_b;
  const geometry::SinCos r = geometry::sincos(T.theta_rad);
  for (const SurfacePoint& point : outline) {
    const SurfacePoint p = moved(point, T, r);
    const auto view = viewer.view_of_face(p.position_m, p.normal, tolerance_m);
    if (view == RangeProfile::View::kFree || view == RangeProfile::View::kSurface) continue;
    unseen += 1.0;
    if (points - unseen < least * points) return 0.0;
  }
  return (points - unseen) / points;
}

}  // namespace topogeo::localization
