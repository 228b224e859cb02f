#include "topogeo/simulation/laser.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::simulation {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Distance from the origin along the unit vector `beam`; infinity for a miss. A segment that the
// beam runs along is met at its nearer end.
double distance_to(const Segment& segment, const Eigen::Vector2d& beam) {
  const double side_a = cross(beam, segment.a_m);
  const double side_b = cross(beam, segment.b_m);
  if ((side_a > 0.0 && side_b > 0.0) || (side_a < 0.0 && side_b < 0.0)) return kInfinity;
  const double along_a_m = beam.dot(segment.a_m);
  const double along_b_m = beam.dot(segment.b_m);
  if (side_a == side_b) {
    const double nearer_m = std::min(along_a_m, along_b_m);
    if (nearer_m > 0.0) return nearer_m;
    return std::max(along_a_m, along_b_m) >= 0.0 ? 0.0 : kInfinity;
  }
  const double share = side_a / (side_a - side_b);
  const double distance_m = along_a_m + share * (along_b_m - along_a_m);
  return distance_m >= 0.0 ? distance_m : kInfinity;
}

double distance_to(const Circle& circle, const Eigen::Vector2d& beam) {
  const double along_m = beam.dot(circle.center_m);
  const double beside_m = cross(beam, circle.center_m);
  const double half2 = circle.radius_m * circle.radius_m - beside_m * beside_m;
  if (half2 < 0.0) return kInfinity;
  const double half_m = std::sqrt(half2);
  if (along_m - half_m >= 0.0) return along_m - half_m;
  return along_m + half_m >= 0.0 ? along_m + half_m : kInfinity;
}

}  // namespace

std::vector<double> raycast(const World& world, const geometry::Pose2& T_world_laser,
                            const BeamPattern& beams) {
  // Surfaces seen from the sensor, without those out of reach.
  const Eigen::Vector2d origin_m = T_world_laser.position_m();
  World near;
  for (const Segment& s : world.segments) {
    if (clearance_m(World{{}, {s}, {}, {}}, origin_m) < beams.range_max_m) {
      near.segments.push_back({s.a_m - origin_m, s.b_m - origin_m});
    }
  }
  for (const Circle& c : world.circles) {
    near.circles.push_back({c.center_m - origin_m, c.radius_m});
  }
  std::vector<double> ranges_m(beams.count);
  for (std::size_t i = 0; i < beams.count; ++i) {
    const double angle_rad = geometry::wrap_angle(T_world_laser.theta_rad + beams.angle_min_rad +
                                                  static_cast<double>(i) * beams.angle_step_rad);
    const geometry::SinCos direction = geometry::sincos(angle_rad);
    const Eigen::Vector2d beam(direction.cos, direction.sin);
    double nearest_m = kInfinity;
    for (const Segment& s : near.segments) nearest_m = std::min(nearest_m, distance_to(s, beam));
    for (const Circle& c : near.circles) nearest_m = std::min(nearest_m, distance_to(c, beam));
    ranges_m[i] = nearest_m < beams.range_max_m ? nearest_m : kInfinity;
  }
  return ranges_m;
}

std::vector<float> measure(const std::vector<double>& ranges_m, const LaserNoise& noise,
                           support::Random& random) {
  std::vector<float> readings_m;
  readings_m.reserve(ranges_m.size());
  for (const double range_m : ranges_m) {
    const bool dropped = random.uniform() < noise.dropout_probability;
    if (dropped || std::isinf(range_m)) {
      readings_m.push_back(scan::Scan::kNoReturn);
      continue;
    }
    double error_m = 0.0;
    if (noise.sigma_m > 0.0 && noise.bound_m > 0.0) {
      do {
        error_m = noise.sigma_m * random.normal();
      } while (std::fabs(error_m) > noise.bound_m);
    }
    double reading_m = range_m + error_m;
    if (noise.resolution_m > 0.0) {
      reading_m = std::floor(reading_m / noise.resolution_m + 0.5) * noise.resolution_m;
    }
    readings_m.push_back(static_cast<float>(std::max(reading_m, 0.0)));
  }
  return readings_m;
}

}  // namespace topogeo::simulation
