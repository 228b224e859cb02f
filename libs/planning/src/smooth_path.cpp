#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/planning/motion_primitives.hpp"

namespace topogeo::planning {
namespace {

constexpr double kStraight_rad = 1e-6;  // less is rounding

struct Arc {
  Eigen::Vector2d begin_m;
  double heading_rad = 0.0;  // at its begin
  double turn_rad = 0.0;
  double radius_m = 0.0;  // 0: turn on the spot

  [[nodiscard]] double length_m() const { return std::fabs(turn_rad) * radius_m; }

  [[nodiscard]] Eigen::Vector2d at(double share) const {
    const double side = turn_rad > 0.0 ? 1.0 : -1.0;
    const auto from = geometry::sincos(heading_rad);
    const auto to = geometry::sincos(heading_rad + share * turn_rad);
    return begin_m + side * radius_m * Eigen::Vector2d(to.sin - from.sin, from.cos - to.cos);
  }
};

class Smoother {
 public:
  Smoother(const FreeSpace& space, const SmoothPathConfig& config)
      : space_(space), config_(config) {}

  std::vector<PathSample> run(const std::vector<Eigen::Vector2d>& points_m) {
    Eigen::Vector2d at_m = points_m[0];
    for (std::size_t i = 1; i < points_m.size(); ++i) {
      const double heading_rad = heading(points_m[i] - points_m[i - 1]);
      Arc arc{points_m[i], heading_rad, 0.0, 0.0};
      if (i + 1 < points_m.size()) arc = corner(points_m, i, at_m);
      straight(at_m, arc.begin_m, heading_rad);
      at_m = arc.radius_m > 0.0 ? arc.at(1.0) : points_m[i];
      follow(arc);
    }
    add({at_m, heading(points_m.back() - points_m[points_m.size() - 2])}, 0.0);
    return std::move(samples_);
  }

 private:
  struct At {
    Eigen::Vector2d position_m;
    double heading_rad;
  };

  static double heading(const Eigen::Vector2d& direction) {
    return geometry::atan2(direction.y(), direction.x());
  }

  // The widest arc that fits at point i: each side of a corner gets half of its line.
  [[nodiscard]] Arc corner(const std::vector<Eigen::Vector2d>& points_m, std::size_t i,
                           const Eigen::Vector2d& at_m) const {
    const Eigen::Vector2d in = (points_m[i] - points_m[i - 1]).normalized();
    const Eigen::Vector2d out = (points_m[i + 1] - points_m[i]).normalized();
    const double cross = in.x() * out.y() - in.y() * out.x();
    const double turn_rad = geometry::atan2(cross, in.dot(out));
    Arc spot{points_m[i], heading(in), turn_rad, 0.0};
    if (std::fabs(turn_rad) < kStraight_rad || 1.0 + in.dot(out) < kStraight_rad) return spot;
    const double tangent_of_half = std::fabs(cross) / (1.0 + in.dot(out));
    const double out_m = (points_m[i + 1] - points_m[i]).norm();
    const double room_m =
        std::min((points_m[i] - at_m).norm(), i + 2 < points_m.size() ? 0.5 * out_m : out_m);
    double radius_m = std::min(room_m / tangent_of_half, config_.max_radius_m);
    constexpr double kNarrower = 0.8;  // of the radius at each try
    for (; radius_m >= config_.min_radius_m; radius_m *= kNarrower) {
      Arc arc{points_m[i] - radius_m * tangent_of_half * in, heading(in), turn_rad, radius_m};
      if (fits(arc)) return arc;
    }
    return spot;
  }

  [[nodiscard]] bool fits(const Arc& arc) const {
    const double step_m = 0.25 * space_.frame().resolution_m;
    const int steps = static_cast<int>(arc.length_m() / step_m) + 1;
    for (int k = 0; k <= steps; ++k) {
      const auto cell = space_.frame().cell_of(arc.at(static_cast<double>(k) / steps));
      if (!cell || !space_.passable(*cell)) return false;
    }
    return true;
  }

  void straight(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m, double heading_rad) {
    const double length = (to_m - from_m).norm();
    const int steps = static_cast<int>(std::ceil(length / config_.step_m));
    for (int k = 0; k < steps; ++k) {
      add({from_m + static_cast<double>(k) / steps * (to_m - from_m), heading_rad}, 0.0);
    }
  }

  // Samples of the arc, or the turn at the next sample.
  void follow(const Arc& arc) {
    if (arc.radius_m == 0.0) {
      turn_rad_ = std::fabs(arc.turn_rad) < kStraight_rad ? 0.0 : arc.turn_rad;
      return;
    }
    const double curvature = (arc.turn_rad > 0.0 ? 1.0 : -1.0) / arc.radius_m;
    const int steps = static_cast<int>(std::ceil(arc.length_m() / config_.step_m));
    for (int k = 0; k < steps; ++k) {
      const double share = static_cast<double>(k) / steps;
      add({arc.at(share), arc.heading_rad + share * arc.turn_rad}, curvature);
    }
  }

  void add(const At& at, double curvature) {
    PathSample sample;
    sample.T_map_robot = {at.position_m.x(), at.position_m.y(),
                          geometry::wrap_angle(at.heading_rad)};
    sample.curvature_per_m = curvature;
    sample.turn_on_spot_rad = turn_rad_;
    turn_rad_ = 0.0;
    if (!samples_.empty()) {
      const PathSample& last = samples_.back();
      // Length of an arc with this chord.
      const double chord_m = (at.position_m - last.T_map_robot.position_m()).norm();
      const double turned_rad = std::fabs(geometry::wrap_angle(
          at.heading_rad - sample.turn_on_spot_rad - last.T_map_robot.theta_rad));
      const double arc_m =
          last.curvature_per_m == 0.0 ? chord_m : turned_rad / std::fabs(last.curvature_per_m);
      sample.distance_m = last.distance_m + arc_m;
    }
    samples_.push_back(sample);
  }

  const FreeSpace& space_;
  const SmoothPathConfig& config_;
  std::vector<PathSample> samples_;
  double turn_rad_ = 0.0;
};

}  // namespace

std::vector<PathSample> smooth_path(const FreeSpace& space,
                                    std::span<const Eigen::Vector2d> points_m,
                                    const SmoothPathConfig& config) {
  check(config);
  std::vector<Eigen::Vector2d> different_m;
  constexpr double kSame_m = 1e-6;
  for (const Eigen::Vector2d& point_m : points_m) {
    if (!point_m.allFinite()) throw std::invalid_argument("smooth path: a point is not finite");
    if (different_m.empty() || (point_m - different_m.back()).norm() > kSame_m) {
      different_m.push_back(point_m);
    }
  }
  if (different_m.size() < 2) return {};
  return Smoother(space, config).run(different_m);
}

}  // namespace topogeo::planning
