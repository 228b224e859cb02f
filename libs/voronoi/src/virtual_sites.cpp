#include "virtual_sites.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::voronoi {
namespace {

struct Axes {
  Eigen::Vector2d forward;
  Eigen::Vector2d left;
};

/// Beam nearest in direction to a point.
std::uint32_t nearest_beam(const BeamDirections& beams, const Eigen::Vector2d& point_m) {
  std::uint32_t best = 0;
  for (std::uint32_t i = 1; i < beams.directions().size(); ++i) {
    if (beams.directions()[i].dot(point_m) > beams.directions()[best].dot(point_m)) best = i;
  }
  return best;
}

/// A line of points at `side_m` to the left of the motion, from the first free place beside the
/// robot as long as space is free. Space beyond the line counts as occupied, as behind a wall.
void add_line(const BeamDirections& beams, std::span<double> free_range_m, const Axes& axes,
              double side_m, double length_m, GeneratorGroups& groups) {
  // A tenth of a metre keeps the branch between two lines straight to a millimetre.
  constexpr double kSpacingM = 0.1;
  const auto begin = static_cast<std::uint32_t>(groups.points.size());
  const int count = static_cast<int>(length_m / kSpacingM);
  for (int i = 0; i <= count; ++i) {
    const Eigen::Vector2d point_m = axes.forward * (i * kSpacingM) + axes.left * side_m;
    const std::uint32_t beam = nearest_beam(beams, point_m);
    const double range_m = point_m.norm();
    if (range_m > free_range_m[beam] || beams.directions()[beam].dot(point_m) < 0.9 * range_m) {
      if (groups.points.size() > begin) break;
      continue;
    }
    groups.points.push_back({point_m, static_cast<float>(range_m), beam});
  }
  const auto end = static_cast<std::uint32_t>(groups.points.size());
  if (end == begin) return;
  groups.groups.push_back({begin, end});
  for (std::size_t i = 0; i < free_range_m.size(); ++i) {
    const Eigen::Vector2d& direction = beams.directions()[i];
    const double reach_m = side_m / axes.left.dot(direction);  // along the beam to the line
    if (reach_m > 0.0) free_range_m[i] = std::min(free_range_m[i], reach_m);
  }
}

}  // namespace

void add_virtual_groups(const BeamDirections& beams, std::span<double> free_range_m,
                        const VoronoiConfig& config, GeneratorGroups& groups) {
  const auto [sin, cos] = geometry::sincos(config.forward_rad);
  const Axes axes{{cos, sin}, {-sin, cos}};
  if (groups.groups.empty()) {
    add_line(beams, free_range_m, axes, -config.virtual_half_width_m, config.range_limit_m, groups);
    add_line(beams, free_range_m, axes, config.virtual_half_width_m, config.range_limit_m, groups);
    return;
  }
  int on_the_left = 0;
  for (const GroupPoint& point : groups.points) {
    on_the_left += axes.left.dot(point.position_m) > 0.0 ? 1 : -1;
  }
  const double group_side = on_the_left > 0 ? 1.0 : -1.0;
  double nearest_m = config.range_limit_m;
  double opposite_m = config.range_limit_m;  // of a group that surrounds the robot
  double length_m = 0.0;
  for (const GroupPoint& point : groups.points) {
    const double side_m = group_side * axes.left.dot(point.position_m);
    const double ahead_m = axes.forward.dot(point.position_m);
    if (side_m > 0.0) length_m = std::max(length_m, ahead_m);
    if (std::abs(side_m) < std::abs(ahead_m)) continue;  // ahead rather than beside
    double& beside_m = side_m > 0.0 ? nearest_m : opposite_m;
    beside_m = std::min(beside_m, std::abs(side_m));
  }
  if (nearest_m == config.range_limit_m) nearest_m = config.virtual_half_width_m;
  const double side_m =
      std::min(std::max(nearest_m, config.virtual_half_width_m), 0.9 * opposite_m);
  add_line(beams, free_range_m, axes, -group_side * side_m, length_m, groups);
}

}  // namespace topogeo::voronoi
