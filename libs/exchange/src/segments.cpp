#include "segments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

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

Eigen::AlignedBox2d box_of(std::span<const Eigen::Vector2d> points) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& point : points) box.extend(point);
  return box;
}

/// An edge of a polygon from one corner to the next, with its box.
struct Edge {
  std::size_t start = 0;  ///< index of the corner
  std::size_t end = 0;
  double low = 0.0;  ///< of the box along the axis of the order
  double high = 0.0;
  double side_low = 0.0;  ///< along the other axis
  double side_high = 0.0;
};

/// The edges by their lower ends along the axis on which the edges are shorter, so that few of
/// their boxes overlap.
std::vector<Edge> edges_in_order(std::span<const Eigen::Vector2d> corners) {
  Eigen::Vector2d lengths = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    lengths += (corners[(i + 1) % corners.size()] - corners[i]).cwiseAbs();
  }
  const Eigen::Index axis = lengths.x() <= lengths.y() ? 0 : 1;
  std::vector<Edge> edges(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::size_t next = (i + 1) % corners.size();
    const Eigen::Vector2d low = corners[i].cwiseMin(corners[next]);
    const Eigen::Vector2d high = corners[i].cwiseMax(corners[next]);
    edges[i] = {i, next, low[axis], high[axis], low[1 - axis], high[1 - axis]};
  }
  std::ranges::sort(edges, {}, &Edge::low);
  return edges;
}

/// Whether two edges share a point that is no common corner, or overlap at it.
bool conflict(std::span<const Eigen::Vector2d> corners, const Edge& one, const Edge& two) {
  const bool follows = one.end == two.start;
  if (!follows && two.end != one.start) {
    return segments_meet(corners[one.start], corners[one.end], corners[two.start],
                         corners[two.end]);
  }
  if (corners.size() == 2) return false;
  const Eigen::Vector2d& shared = corners[follows ? one.end : one.start];
  const Eigen::Vector2d& mine = corners[follows ? one.start : one.end];
  const Eigen::Vector2d& other = corners[follows ? two.end : two.start];
  return side(mine, shared, other) == 0 && (mine - shared).dot(other - shared) > 0.0;
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
  const std::vector<Edge> edges = edges_in_order(corners);
  for (auto edge = edges.begin(); edge != edges.end(); ++edge) {
    if (corners[edge->start] == corners[edge->end]) return false;
    // The boxes of edges that meet overlap.
    for (auto other = edge + 1; other != edges.end() && other->low <= edge->high; ++other) {
      if (other->side_low > edge->side_high || other->side_high < edge->side_low) continue;
      if (conflict(corners, *edge, *other)) return false;
    }
  }
  return true;
}

bool polygons_overlap(std::span<const Eigen::Vector2d> a, std::span<const Eigen::Vector2d> b) {
  const Eigen::AlignedBox2d box_b = box_of(b);
  if (!box_of(a).intersects(box_b)) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector2d& end = a[(i + 1) % a.size()];
    if (!box_of(std::array{a[i], end}).intersects(box_b)) continue;
    for (std::size_t j = 0; j < b.size(); ++j) {
      if (cross_inside(a[i], end, b[j], b[(j + 1) % b.size()])) return true;
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
