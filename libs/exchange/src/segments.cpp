#include "segments.hpp"

#include <cmath>

namespace topogeo::exchange {
namespace {

int side(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& p) {
  const double turn = cross(b - a, p - a);
  return (turn > 0.0) - (turn < 0.0);
}

/// Whether a point on the line through a and b lies between them.
bool between_ends(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& p) {
  return (p.array() >= a.cwiseMin(b).array()).all() && (p.array() <= a.cwiseMax(b).array()).all();
}

/// Whether the inner points of two segments cross.
bool cross_inside(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                  const Eigen::Vector2d& d) {
  return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}

}  // namespace

bool segments_meet(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                   const Eigen::Vector2d& d) {
  const int c_side = side(a, b, c);
  const int d_side = side(a, b, d);
  const int a_side = side(c, d, a);
  const int b_side = side(c, d, b);
  if (c_side * d_side < 0 && a_side * b_side < 0) return true;
  return (c_side == 0 && between_ends(a, b, c)) || (d_side == 0 && between_ends(a, b, d)) ||
         (a_side == 0 && between_ends(c, d, a)) || (b_side == 0 && between_ends(c, d, b));
}

double signed_area2(std::span<const Eigen::Vector2d> corners) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    sum += cross(corners[i], corners[(i + 1) % corners.size()]);
  }
  return sum;
}

bool inside(std::span<const Eigen::Vector2d> corners, const Eigen::Vector2d& p) {
  bool odd = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& a = corners[i];
    const Eigen::Vector2d& b = corners[(i + 1) % corners.size()];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) odd = !odd;
  }
  return odd;
}

bool segment_touches(std::span<const Eigen::Vector2d> corners, const Eigen::Vector2d& a,
                     const Eigen::Vector2d& b) {
  if (inside(corners, a) || inside(corners, b)) return true;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (segments_meet(corners[i], corners[(i + 1) % corners.size()], a, b)) return true;
  }
  return false;
}

bool is_simple(std::span<const Eigen::Vector2d> corners) {
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d& a = corners[i];
    const Eigen::Vector2d& b = corners[(i + 1) % n];
    if (a == b) return false;
    for (std::size_t j = i + 1; j < n; ++j) {
      const Eigen::Vector2d& c = corners[j];
      const Eigen::Vector2d& d = corners[(j + 1) % n];
      const bool follows = j == i + 1;
      const bool precedes = (j + 1) % n == i;
      if (!follows && !precedes) {
        if (segments_meet(a, b, c, d)) return false;
      } else if (n > 2) {
        // Neighbours share a corner; they must not overlap.
        const Eigen::Vector2d& shared = follows ? b : a;
        const Eigen::Vector2d& mine = follows ? a : b;
        const Eigen::Vector2d& other = follows ? d : c;
        if (side(mine, shared, other) == 0 && (mine - shared).dot(other - shared) > 0.0) {
          return false;
        }
      }
    }
  }
  return true;
}

bool polygons_overlap(std::span<const Eigen::Vector2d> a, std::span<const Eigen::Vector2d> b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      if (cross_inside(a[i], a[(i + 1) % a.size()], b[j], b[(j + 1) % b.size()])) return true;
    }
  }
  // Without crossing edges, one polygon contains the other, or they are apart or touch. The mean of
  // each one's corners decides.
  const auto any_inside = [](std::span<const Eigen::Vector2d> of,
                             std::span<const Eigen::Vector2d> in) {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& corner : of) middle += corner;
    return inside(in, middle / static_cast<double>(of.size()));
  };
  return any_inside(a, b) || any_inside(b, a);
}

}  // namespace topogeo::exchange
