// How well two local maps agree at a relative pose (Thesis, 6.2.5; docs/algorithms.md, "Fitness"):
// the quantity that the genetic search maximises. The forms share this interface; their headers
// describe them.
#pragma once

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/matching/match_features.hpp"

namespace topogeo::localization {

class Fitness {
 public:
  Fitness() = default;
  Fitness(const Fitness&) = default;
  Fitness& operator=(const Fitness&) = default;
  virtual ~Fitness() = default;

  /// Fitness in [0, 1] at T_reference_query, whose heading has the sine and cosine `heading`. No
  /// allocation.
  [[nodiscard]] virtual double at(const geometry::Pose2& T_reference_query,
                                  const geometry::SinCos& heading) const = 0;

  [[nodiscard]] double operator()(const geometry::Pose2& T_reference_query) const {
    return at(T_reference_query, geometry::sincos(T_reference_query.theta_rad));
  }
};

}  // namespace topogeo::localization
