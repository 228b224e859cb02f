#include "topogeo/geometry/footprint.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "topogeo/geometry/segment.hpp"

namespace topogeo::geometry {
namespace {

using Point = Eigen::Vector2d;

double distance_to_edge_m(const Point& a_m, const Point& b_m, const Point& point_m) {
  return (nearest_on_segment(a_m, b_m, point_m).point_m - point_m).norm();
}

double cross(const Point& a, const Point& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool edges_meet(const Point& a_m, const Point& b_m, const Point& c_m, const Point& d_m) {
  constexpr double kTouch_m = 1e-6;
  const double c_side = cross(b_m - a_m, c_m - a_m);
  const double d_side = cross(b_m - a_m, d_m - a_m);
  const double a_side = cross(d_m - c_m, a_m - c_m);
  const double b_side = cross(d_m - c_m, b_m - c_m);
  if (c_side * d_side < 0.0 && a_side * b_side < 0.0) return true;
  return distance_to_edge_m(a_m, b_m, c_m) < kTouch_m ||
         distance_to_edge_m(a_m, b_m, d_m) < kTouch_m ||
         distance_to_edge_m(c_m, d_m, a_m) < kTouch_m ||
         distance_to_edge_m(c_m, d_m, b_m) < kTouch_m;
}

bool is_simple(const std::vector<Point>& corners_m) {
  const std::size_t count = corners_m.size();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 2; j < count; ++j) {
      if (i == 0 && j + 1 == count) continue;  // neighbours share a corner
      if (edges_meet(corners_m[i], corners_m[i + 1], corners_m[j], corners_m[(j + 1) % count])) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

double signed_distance_m(const Footprint& footprint, const Point& point_m) {
  double least_m = std::numeric_limits<double>::infinity();
  bool inside = false;
  const auto& corners_m = footprint.corners_m;
  for (std::size_t i = 0, before = corners_m.size() - 1; i < corners_m.size(); before = i++) {
    const Point& a_m = corners_m[before];
    const Point& b_m = corners_m[i];
    least_m = std::min(least_m, distance_to_edge_m(a_m, b_m, point_m));
    if ((a_m.y() > point_m.y()) == (b_m.y() > point_m.y())) continue;
    const double share = (point_m.y() - a_m.y()) / (b_m.y() - a_m.y());
    if (point_m.x() < a_m.x() + share * (b_m.x() - a_m.x())) inside = !inside;
  }
  return inside ? -least_m : least_m;
}

double inscribed_radius_m(const Footprint& footprint) {
  return footprint.empty() ? 0.0 : std::max(0.0, -signed_distance_m(footprint, Point::Zero()));
}

double circumscribed_radius_m(const Footprint& footprint) {
  double most_m = 0.0;
  for (const Point& corner_m : footprint.corners_m) most_m = std::max(most_m, corner_m.norm());
  return most_m;
}

std::vector<Point> covering_points_m(const Footprint& footprint, double spacing_m) {
  std::vector<Point> points_m;
  const auto& corners_m = footprint.corners_m;
  for (std::size_t i = 0; i < corners_m.size(); ++i) {
    const Point edge_m = corners_m[(i + 1) % corners_m.size()] - corners_m[i];
    const int pieces = std::max(1, static_cast<int>(std::ceil(edge_m.norm() / spacing_m)));
    for (int k = 0; k < pieces; ++k) {
      points_m.emplace_back(corners_m[i] + static_cast<double>(k) / pieces * edge_m);
    }
  }
  const auto reach = static_cast<int>(circumscribed_radius_m(footprint) / spacing_m) + 1;
  for (int row = -reach; row <= reach; ++row) {
    for (int column = -reach; column <= reach; ++column) {
      const Point point_m = spacing_m * Point(column, row);
      if (!corners_m.empty() && signed_distance_m(footprint, point_m) < -0.5 * spacing_m) {
        points_m.push_back(point_m);
      }
    }
  }
  return points_m;
}

std::string fault_of(const Footprint& footprint) {
  const auto& corners_m = footprint.corners_m;
  if (corners_m.empty()) return {};
  if (corners_m.size() < 3 || corners_m.size() > Footprint::kMostCorners) {
    return "has " + std::to_string(corners_m.size()) + " corners, expected 3 to " +
           std::to_string(Footprint::kMostCorners);
  }
  for (const Point& corner_m : corners_m) {
    if (!corner_m.allFinite() || corner_m.norm() > Footprint::kFarthest_m) {
      return "has a corner that is not within 3 m of the origin";
    }
  }
  if (!is_simple(corners_m)) return "has edges that touch each other";
  if (inscribed_radius_m(footprint) < Footprint::kLeastInscribed_m ||
      signed_distance_m(footprint, Point::Zero()) >= 0.0) {
    return "does not contain the origin, or less than 0.05 m from its outline";
  }
  return {};
}

}  // namespace topogeo::geometry
