#include "topogeo/simulation/contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "topogeo/geometry/segment.hpp"

namespace topogeo::simulation {
namespace {

constexpr double kNoContact_m = std::numeric_limits<double>::infinity();
constexpr double kTouch_m = 1e-9;    // within this distance counts as touching
constexpr double kOverlap_m = 1e-4;  // less is a touch with rounding errors
// A move along a wall does not approach it, whatever the rounding.
constexpr double kSidelong = 1e-6;

Eigen::Vector2d nearest_m(const world::Segment& segment, const Eigen::Vector2d& point_m) {
  return geometry::nearest_on_segment(segment.a_m, segment.b_m, point_m).point_m;
}

// Distance until a point that moves along `direction` is `radius_m` away from `center_m`, starting
// outside.
double distance_to_circle(const Eigen::Vector2d& center_m, double radius_m,
                          const Eigen::Vector2d& from_m, const Eigen::Vector2d& direction) {
  const Eigen::Vector2d to_m = center_m - from_m;
  const double along_m = to_m.dot(direction);
  if (along_m <= 0.0) return kNoContact_m;
  // Grazing is no contact, even with rounding errors.
  const double beside_m = (to_m - along_m * direction).norm();
  if (beside_m >= radius_m - kTouch_m) return kNoContact_m;
  return std::max(along_m - std::sqrt(radius_m * radius_m - beside_m * beside_m), 0.0);
}

// The same for a segment and a point more than `radius_m` away from it.
double distance_to_segment(const world::Segment& segment, double radius_m,
                           const Eigen::Vector2d& from_m, const Eigen::Vector2d& direction) {
  const Eigen::Vector2d span_m = segment.b_m - segment.a_m;
  const double length_m = span_m.norm();
  if (length_m > 0.0) {
    const Eigen::Vector2d along = span_m / length_m;
    const Eigen::Vector2d normal(-along.y(), along.x());
    const double beside_m = normal.dot(from_m - segment.a_m);
    const double approach = normal.dot(direction) * (beside_m > 0.0 ? -1.0 : 1.0);
    if (std::fabs(beside_m) > radius_m && approach > 0.0) {
      const double distance_m = (std::fabs(beside_m) - radius_m) / approach;
      const double at_m = along.dot(from_m + distance_m * direction - segment.a_m);
      if (at_m >= 0.0 && at_m <= length_m) return distance_m;
    }
  }
  return std::min(distance_to_circle(segment.a_m, radius_m, from_m, direction),
                  distance_to_circle(segment.b_m, radius_m, from_m, direction));
}

class PathAhead {
 public:
  PathAhead(const Eigen::Vector2d& from_m, const Eigen::Vector2d& direction, double length_m)
      : from_m_(from_m), direction_(direction), free_{length_m, std::nullopt} {}

  [[nodiscard]] const FreePath& free() const { return free_; }

  // Whether the surface with this nearest point, `room_m` away from the disc, is already decided:
  // out of reach, touched, or overlapped.
  bool settled(const Eigen::Vector2d& nearest, double room_m) {
    if (room_m >= free_.distance_m + kTouch_m) return true;
    if (room_m > kTouch_m) return false;
    const Eigen::Vector2d to_m = nearest - from_m_;
    // Any move leads away from a point on the surface itself.
    if (to_m.dot(direction_) > kSidelong * to_m.norm()) stop(0.0, nearest);
    return true;
  }

  void stop(double distance_m, const Eigen::Vector2d& contact_m) {
    if (distance_m >= free_.distance_m && free_.contact_m) return;
    free_ = {distance_m, contact_m};
  }

 private:
  const Eigen::Vector2d& from_m_;
  const Eigen::Vector2d& direction_;
  FreePath free_;
};

}  // namespace

FreePath free_path(const world::World& scene, const Eigen::Vector2d& from_m,
                   const Eigen::Vector2d& direction, double length_m, double radius_m) {
  PathAhead path(from_m, direction, length_m);
  for (const world::Segment& segment : scene.segments) {
    const Eigen::Vector2d nearest = nearest_m(segment, from_m);
    if (path.settled(nearest, (nearest - from_m).norm() - radius_m)) continue;
    const double distance_m = distance_to_segment(segment, radius_m, from_m, direction);
    if (distance_m < path.free().distance_m) {
      path.stop(distance_m, nearest_m(segment, from_m + distance_m * direction));
    }
  }
  for (const world::Circle& circle : scene.circles) {
    const double apart_m = (circle.center_m - from_m).norm();
    if (path.settled(circle.center_m, apart_m - circle.radius_m - radius_m)) continue;
    const double distance_m =
        distance_to_circle(circle.center_m, circle.radius_m + radius_m, from_m, direction);
    if (distance_m >= path.free().distance_m) continue;
    const Eigen::Vector2d there_m = from_m + distance_m * direction;
    const Eigen::Vector2d out = (there_m - circle.center_m).normalized();
    path.stop(distance_m, circle.center_m + circle.radius_m * out);
  }
  return path.free();
}

namespace {

/// Point of a segment inside of the outline; both in the robot's frame.
std::optional<Eigen::Vector2d> inside_m(const geometry::Footprint& footprint,
                                        const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) {
  if (geometry::signed_distance_m(footprint, a_m) < 0.0) return a_m;
  if (geometry::signed_distance_m(footprint, b_m) < 0.0) return b_m;
  const auto cross = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
    return p.x() * q.y() - p.y() * q.x();
  };
  const Eigen::Vector2d wall_m = b_m - a_m;
  const auto& corners_m = footprint.corners_m;
  for (std::size_t i = 0; i < corners_m.size(); ++i) {
    const Eigen::Vector2d edge_m = corners_m[(i + 1) % corners_m.size()] - corners_m[i];
    const double across = cross(wall_m, edge_m);
    if (across == 0.0) continue;
    const Eigen::Vector2d to_m = corners_m[i] - a_m;
    const double on_wall = cross(to_m, edge_m) / across;
    const double on_edge = cross(to_m, wall_m) / across;
    if (on_wall >= 0.0 && on_wall <= 1.0 && on_edge >= 0.0 && on_edge <= 1.0) {
      return a_m + on_wall * wall_m;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<Eigen::Vector2d> overlap_m(const world::World& scene, const geometry::Pose2& pose,
                                         const geometry::Footprint& footprint) {
  const double around_m = geometry::circumscribed_radius_m(footprint);
  const geometry::Pose2 T_robot_world = geometry::inverse(pose);
  for (const world::Segment& segment : scene.segments) {
    if ((nearest_m(segment, pose.position_m()) - pose.position_m()).norm() > around_m) continue;
    const auto point_m =
        inside_m(footprint, T_robot_world * segment.a_m, T_robot_world * segment.b_m);
    if (point_m) return pose * *point_m;
  }
  for (const world::Circle& circle : scene.circles) {
    const double apart_m = geometry::signed_distance_m(footprint, T_robot_world * circle.center_m);
    if (apart_m < circle.radius_m) return circle.center_m;
  }
  return std::nullopt;
}

std::optional<Eigen::Vector2d> overlap_m(const world::World& scene, const Eigen::Vector2d& center_m,
                                         double radius_m) {
  std::optional<Eigen::Vector2d> found;
  double least_m = radius_m - kOverlap_m;
  const auto compare = [&](const Eigen::Vector2d& nearest, double apart_m) {
    if (apart_m >= least_m) return;
    least_m = apart_m;
    found = nearest;
  };
  for (const world::Segment& segment : scene.segments) {
    const Eigen::Vector2d nearest = nearest_m(segment, center_m);
    compare(nearest, (nearest - center_m).norm());
  }
  for (const world::Circle& circle : scene.circles) {
    compare(circle.center_m, (circle.center_m - center_m).norm() - circle.radius_m);
  }
  return found;
}

}  // namespace topogeo::simulation
