#include "nurbs.hpp"

#include <algorithm>

namespace topogeo::exchange {

std::string Nurbs::fault() const {
  if (points.size() < degree + 1) return "more control points than the degree";
  if (knots.size() != points.size() + degree + 1) {
    return "a knotVector of control points + degree + 1 numbers";
  }
  if (!std::ranges::is_sorted(knots)) return "a knotVector that never decreases";
  if (!(knots[degree] < knots[points.size()])) return "a knotVector that increases";
  const auto positive = [](double weight) { return weight > 0.0; };
  if (!std::ranges::all_of(weights, positive)) return "weights above 0";
  return "";
}

Eigen::Vector2d Nurbs::at(double u) const {
  // The span whose knots enclose u; the last one includes its upper end.
  const auto first = knots.begin() + static_cast<std::ptrdiff_t>(degree);
  const auto last = knots.begin() + static_cast<std::ptrdiff_t>(points.size());
  const auto above = std::upper_bound(first + 1, last, u);
  const auto span = static_cast<std::size_t>(above - knots.begin()) - 1;
  std::vector<Eigen::Vector3d> work;
  for (std::size_t i = span - degree; i <= span; ++i) {
    work.emplace_back(weights[i] * points[i].x(), weights[i] * points[i].y(), weights[i]);
  }
  for (std::size_t level = 1; level <= degree; ++level) {
    for (std::size_t j = degree; j >= level; --j) {
      const std::size_t i = span - degree + j;
      const double width = knots[i + degree + 1 - level] - knots[i];
      const double share = width > 0.0 ? (u - knots[i]) / width : 0.0;
      work[j] = (1.0 - share) * work[j - 1] + share * work[j];
    }
  }
  return work[degree].head<2>() / work[degree].z();
}

std::vector<Eigen::Vector2d> Nurbs::polyline() const {
  if (degree == 1) return points;
  constexpr int kSteps = 8;
  std::vector<Eigen::Vector2d> line{at(knots[degree])};
  for (std::size_t i = degree; i < points.size(); ++i) {
    if (!(knots[i] < knots[i + 1])) continue;
    for (int step = 1; step <= kSteps; ++step) {
      line.push_back(at(knots[i] + (knots[i + 1] - knots[i]) * step / kSteps));
    }
  }
  return line;
}

}  // namespace topogeo::exchange
