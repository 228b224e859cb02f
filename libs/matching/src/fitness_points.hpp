// Vector arithmetic of the fitness forms: four points at once, in single precision, on every CPU.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace topogeo::localization {

using Lanes = Eigen::Array4f;

/// Points of one block of work; its intermediate results stay in the nearest cache.
inline constexpr std::size_t kBlock = 64;

/// One number per point, padded to a multiple of four.
class LaneArray {
 public:
  void clear() { values_.clear(); }
  void add(double value) { values_.push_back(static_cast<float>(value)); }
  /// Pads to a multiple of four.
  void pad(double value) {
    while (values_.size() % 4 != 0) add(value);
  }
  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] Eigen::Map<const Lanes> lanes(std::size_t first) const {
    return Eigen::Map<const Lanes>(values_.data() + first);
  }

 private:
  std::vector<float> values_;
};

/// Coordinate of padding points: so far away that nothing is near.
inline constexpr double kPadding_m = 1e8;

/// A pose in single precision.
struct FloatPose {
  float x_m;
  float y_m;
  float sin;
  float cos;
};

/// 1 at 0, falling to 0 at a width.
inline Lanes kernel(const Lanes& squared, float width) {
  const Lanes u = 1.0F - squared.min(width * width) * (1.0F / (width * width));
  return u * u;
}

/// Sum in an order that is the same on every machine.
inline double sum_of(const Lanes& lanes) {
  return static_cast<double>((lanes[0] + lanes[1]) + (lanes[2] + lanes[3]));
}

}  // namespace topogeo::localization
