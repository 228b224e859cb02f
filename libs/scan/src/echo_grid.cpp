#include "topogeo/scan/echo_grid.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::scan {
namespace {

/// Neighbouring echoes that are closer than this belong to one surface.
constexpr double kOneSurface_m = 0.2;

/// The distance at which a ray meets the line from `a` to `b`; empty if it does not.
std::optional<double> meet(double angle_rad, const Echo& a, const Echo& b) {
  const auto [sine, cosine] = geometry::sincos(angle_rad);
  const Eigen::Vector2d ray(cosine, sine);
  const Eigen::Vector2d edge = b.point_m - a.point_m;
  const double denominator = ray.x() * edge.y() - ray.y() * edge.x();
  if (std::fabs(denominator) < 1e-12) return std::nullopt;
  const double range_m = (a.point_m.x() * edge.y() - a.point_m.y() * edge.x()) / denominator;
  return range_m > 0.0 ? std::optional(range_m) : std::nullopt;
}

}  // namespace

std::vector<float> on_grid(std::vector<Echo> echoes, const EchoGrid& grid) {
  std::ranges::sort(echoes, {}, &Echo::angle_rad);
  std::vector<float> ranges_m(grid.beams, Scan::kNoReturn);
  const double reach_rad = 1.5 * grid.angle_step_rad;
  std::size_t next = 0;
  for (std::size_t i = 0; i < grid.beams; ++i) {
    const double angle_rad = grid.angle_min_rad + static_cast<double>(i) * grid.angle_step_rad;
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
    const double half_rad = 0.5 * grid.angle_step_rad * (1.0 + 1e-6);
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

}  // namespace topogeo::scan
