#include "topogeo/simulation/sonar.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::simulation {
namespace {

// A cone with its apex at the origin, opening along x.
class Cone {
 public:
  Cone(double half_rad, double range_max_m) : edge_(geometry::sincos(half_rad)) {
    echo_limit_m_ = range_max_m;
  }

  [[nodiscard]] const Echo& nearest() const { return nearest_; }

  void add_echo_of(const world::Segment& segment) {
    // The part of the segment between the two edges, as fractions [first, last].
    double first = 0.0;
    double last = 1.0;
    for (const double side : {1.0, -1.0}) {
      const double a_in_m = edge_.sin * segment.a_m.x() - side * edge_.cos * segment.a_m.y();
      const double b_in_m = edge_.sin * segment.b_m.x() - side * edge_.cos * segment.b_m.y();
      if (a_in_m < 0.0 && b_in_m < 0.0) return;
      if (a_in_m < 0.0) first = std::max(first, a_in_m / (a_in_m - b_in_m));
      if (b_in_m < 0.0) last = std::min(last, a_in_m / (a_in_m - b_in_m));
    }
    if (first > last) return;
    const Eigen::Vector2d along = segment.b_m - segment.a_m;
    const double length2 = along.squaredNorm();
    const double foot = length2 > 0.0 ? -segment.a_m.dot(along) / length2 : 0.0;
    const double share = std::clamp(foot, first, last);
    const Eigen::Vector2d point_m = segment.a_m + share * along;
    const bool edge = share == 0.0 || share == 1.0;
    add_echo_of(point_m, edge ? point_m : Eigen::Vector2d(-along.y(), along.x()));
  }

  void add_echo_of(const world::Circle& circle) {
    const Eigen::Vector2d& center_m = circle.center_m;
    const double apart_m = center_m.norm();
    if (apart_m <= circle.radius_m) return add_echo_of({0.0, 0.0}, {1.0, 0.0});
    const Eigen::Vector2d edge(edge_.cos, center_m.y() >= 0.0 ? edge_.sin : -edge_.sin);
    const bool inside = edge_.sin * center_m.x() - edge_.cos * std::fabs(center_m.y()) >= 0.0;
    if (inside) return add_echo_of(center_m * (1.0 - circle.radius_m / apart_m), center_m);
    // The nearest part of its outline inside the cone lies on the cone's edge.
    const double along_m = edge.dot(center_m);
    const double half2 =
        circle.radius_m * circle.radius_m - (center_m - along_m * edge).squaredNorm();
    if (along_m <= 0.0 || half2 < 0.0) return;
    const Eigen::Vector2d point_m = (along_m - std::sqrt(half2)) * edge;
    add_echo_of(point_m, center_m - point_m);
  }

 private:
  void add_echo_of(const Eigen::Vector2d& point_m, const Eigen::Vector2d& normal) {
    const double range_m = point_m.norm();
    if (range_m >= echo_limit_m_ || range_m >= nearest_.range_m) return;
    const double beside = std::fabs(point_m.x() * normal.y() - point_m.y() * normal.x());
    nearest_ = {range_m, geometry::atan2(beside, std::fabs(point_m.dot(normal)))};
  }

  geometry::SinCos edge_;
  double echo_limit_m_;
  Echo nearest_;
};

struct Disturbance {
  bool reflected = false;
  double detour_m = 0.0;
  bool missing = false;
  double far_error_m = 0.0;
};

/// Draws nothing for disabled settings.
Disturbance draw_disturbance(const SonarNoise& noise, support::Random& random) {
  Disturbance drawn;
  if (noise.reflection_probability > 0.0) {
    drawn.reflected = random.uniform() < noise.reflection_probability;
    drawn.detour_m = random.uniform(0.0, noise.reflection_detour_m);
  }
  if (noise.missing_probability > 0.0) {
    drawn.missing = random.uniform() < noise.missing_probability;
  }
  if (noise.far_error_probability > 0.0) {
    const bool off = random.uniform() < noise.far_error_probability;
    const double error_m = random.uniform(-noise.far_error_m, noise.far_error_m);
    if (off) drawn.far_error_m = error_m;
  }
  return drawn;
}

}  // namespace

Echo echo(const world::World& scene, const geometry::Pose2& T_world_sonar, double half_cone_rad,
          double range_max_m) {
  const geometry::Pose2 T_sonar_world = geometry::inverse(T_world_sonar);
  const geometry::SinCos turn = geometry::sincos(T_sonar_world.theta_rad);
  const auto seen = [&](const Eigen::Vector2d& point_m) {
    return Eigen::Vector2d(T_sonar_world.x_m + turn.cos * point_m.x() - turn.sin * point_m.y(),
                           T_sonar_world.y_m + turn.sin * point_m.x() + turn.cos * point_m.y());
  };
  Cone cone(half_cone_rad, range_max_m);
  for (const world::Segment& segment : scene.segments)
    cone.add_echo_of({seen(segment.a_m), seen(segment.b_m)});
  for (const world::Circle& circle : scene.circles)
    cone.add_echo_of({seen(circle.center_m), circle.radius_m});
  return cone.nearest();
}

SonarNoise macondo_sonar_noise() {
  SonarNoise noise;
  noise.specular_loss_probability = 0.6;
  noise.reflection_probability = 0.5;
  noise.missing_probability = 0.03;
  noise.far_error_probability = 0.75;
  return noise;
}

std::vector<float> measure(const std::vector<Echo>& echoes, const SonarNoise& noise,
                           support::Random& random) {
  std::vector<float> readings_m;
  readings_m.reserve(echoes.size());
  for (const Echo& echo : echoes) {
    const bool lost = random.uniform() < noise.specular_loss_probability &&
                      echo.incidence_rad > noise.specular_from_rad;
    const double error_m = noise.sigma_m * random.normal();
    const Disturbance disturbance = draw_disturbance(noise, random);
    double reading_m = echo.range_m + error_m;
    if (reading_m > noise.far_from_m) reading_m += disturbance.far_error_m;
    if (lost) reading_m = echo.range_m + disturbance.detour_m;
    if (disturbance.missing || (lost && !disturbance.reflected) ||
        std::max(echo.range_m, lost ? reading_m : 0.0) >= noise.range_max_m) {
      readings_m.push_back(scan::Scan::kNoReturn);
      continue;
    }
    if (noise.resolution_m > 0.0) {
      reading_m = std::floor(reading_m / noise.resolution_m + 0.5) * noise.resolution_m;
    }
    readings_m.push_back(
        static_cast<float>(std::clamp(reading_m, noise.range_min_m, noise.range_max_m)));
  }
  return readings_m;
}

}  // namespace topogeo::simulation
