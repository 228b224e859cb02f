#include "topogeo/simulation/laser.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::simulation {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Distance from the origin along the unit vector `beam`; infinity for a miss. A beam along a
// segment meets its nearer end.
double distance_to(const world::Segment& segment, const Eigen::Vector2d& beam) {
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

double distance_to(const world::Circle& circle, const Eigen::Vector2d& beam) {
  const double along_m = beam.dot(circle.center_m);
  const double beside_m = cross(beam, circle.center_m);
  const double half2 = circle.radius_m * circle.radius_m - beside_m * beside_m;
  if (half2 < 0.0) return kInfinity;
  const double half_m = std::sqrt(half2);
  if (along_m - half_m >= 0.0) return along_m - half_m;
  return along_m + half_m >= 0.0 ? along_m + half_m : kInfinity;
}

double distance_m(const world::Segment& segment) {
  const Eigen::Vector2d along = segment.b_m - segment.a_m;
  const double length2 = along.squaredNorm();
  const double share =
      length2 > 0.0 ? std::clamp(-segment.a_m.dot(along) / length2, 0.0, 1.0) : 0.0;
  return (segment.a_m + share * along).norm();
}

// Calls `use` with every beam that can meet a segment, plus two at each end, or with all beams if
// the sensor is practically on it. So the angles need not be exact.
template <typename Use>
void for_beams_of(const world::Segment& segment, double heading_rad, const BeamPattern& beams,
                  const Use& use) {
  constexpr double kOnIt_m = 1e-3;
  constexpr double kMargin = 2.0;  // beams
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  if (distance_m(segment) < kOnIt_m) {
    for (std::size_t i = 0; i < beams.count; ++i) use(i);
    return;
  }
  const double a_rad = std::atan2(segment.a_m.y(), segment.a_m.x());
  const double b_rad = std::atan2(segment.b_m.y(), segment.b_m.x());
  const double span_rad = geometry::wrap_angle(b_rad - a_rad);
  const double first_rad = (span_rad >= 0.0 ? a_rad : b_rad) - heading_rad - beams.angle_min_rad;
  const auto last_beam = static_cast<double>(beams.count - 1);
  const double low = first_rad / beams.angle_step_rad;
  const double turn = kTurn_rad / beams.angle_step_rad;
  const double width = std::fabs(span_rad) / beams.angle_step_rad;
  const double start = low - turn * std::ceil((low + width + kMargin) / turn);
  for (double at = start; at - kMargin <= last_beam; at += turn) {
    const double from = std::max(std::floor(at - kMargin), 0.0);
    const double to = std::min(std::ceil(at + width + kMargin), last_beam);
    for (double i = from; i <= to; i += 1.0) use(static_cast<std::size_t>(i));
  }
}

}  // namespace

std::vector<double> raycast(const world::World& world, const geometry::Pose2& T_world_laser,
                            const BeamPattern& beams) {
  const Eigen::Vector2d origin_m = T_world_laser.position_m();
  std::vector<Eigen::Vector2d> directions;
  for (std::size_t i = 0; i < beams.count; ++i) {
    const double angle_rad = geometry::wrap_angle(T_world_laser.theta_rad + beams.angle_min_rad +
                                                  static_cast<double>(i) * beams.angle_step_rad);
    const geometry::SinCos direction = geometry::sincos(angle_rad);
    directions.emplace_back(direction.cos, direction.sin);
  }
  std::vector<double> ranges_m(beams.count, kInfinity);
  for (const world::Segment& segment : world.segments) {
    const world::Segment seen{segment.a_m - origin_m, segment.b_m - origin_m};
    if (distance_m(seen) >= beams.range_max_m) continue;
    for_beams_of(seen, T_world_laser.theta_rad, beams, [&](std::size_t i) {
      ranges_m[i] = std::min(ranges_m[i], distance_to(seen, directions[i]));
    });
  }
  for (const world::Circle& circle : world.circles) {
    const world::Circle seen{circle.center_m - origin_m, circle.radius_m};
    for (std::size_t i = 0; i < beams.count; ++i) {
      ranges_m[i] = std::min(ranges_m[i], distance_to(seen, directions[i]));
    }
  }
  for (double& range_m : ranges_m) {
    if (range_m >= beams.range_max_m) range_m = kInfinity;
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
