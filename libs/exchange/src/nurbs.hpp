// Curves of LIF and VDA 5050: non-uniform rational B-splines (Piegl, Tiller, "The NURBS Book", 2nd
// ed., 1997, chapter 4).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace topogeo::exchange {

struct Nurbs {
  std::size_t degree = 1;
  std::vector<double> knots;
  std::vector<Eigen::Vector2d> points;
  std::vector<double> weights;  ///< as many as points

  /// The fault of the parts, as an expectation; "" for a valid curve.
  [[nodiscard]] std::string fault() const;

  /// The point at u within the knots, by de Boor's algorithm with weights (algorithm A4.1).
  [[nodiscard]] Eigen::Vector2d at(double u) const;

  /// The control points of a curve of degree 1; otherwise eight points for each span of knots.
  [[nodiscard]] std::vector<Eigen::Vector2d> polyline() const;
};

}  // namespace topogeo::exchange
