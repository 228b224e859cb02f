#include "topogeo/localization/expected_overlap.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::localization {

std::vector<Eigen::Vector2d> outline_of(std::span<const Eigen::Vector2d> coarse_m) {
  constexpr std::size_t kPoints = 40;
  const std::size_t stride = std::max<std::size_t>(1, coarse_m.size() / kPoints);
  std::vector<Eigen::Vector2d> outline_m;
  for (std::size_t i = 0; i < coarse_m.size(); i += stride) outline_m.push_back(coarse_m[i]);
  return outline_m;
}

double expected_overlap(const RangeProfile& viewer, std::span<const Eigen::Vector2d> outline_m,
                        const UncertainPose& T_viewer_outline, double least) {
  if (outline_m.empty()) return 0.0;
  const Eigen::Matrix3d& covariance = T_viewer_outline.covariance;
  const double tolerance_m = 0.5 + 2.0 * std::sqrt(std::max(covariance(0, 0), covariance(1, 1)));
  const auto points = static_cast<double>(outline_m.size());
  double unseen = 0.0;
  const geometry::Pose2& T = T_viewer_outline.T_a_b;
  const geometry::SinCos r = geometry::sincos(T.theta_rad);
  for (const Eigen::Vector2d& p : outline_m) {
    const auto view =
        viewer.view({T.x_m + r.cos * p.x() - r.sin * p.y(), T.y_m + r.sin * p.x() + r.cos * p.y()},
                    tolerance_m);
    if (view == RangeProfile::View::kFree || view == RangeProfile::View::kSurface) continue;
    unseen += 1.0;
    if (points - unseen < least * points) return 0.0;
  }
  return (points - unseen) / points;
}

}  // namespace topogeo::localization
