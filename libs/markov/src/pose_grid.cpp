#include "topogeo/markov/pose_grid.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::markov {

PoseGrid::PoseGrid(int side, double cell_m, int headings, double heading_step_rad)
    : side_(side | 1),
      headings_(headings | 1),
      cell_m_(cell_m),
      heading_step_rad_(heading_step_rad),
      values_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_) *
                  static_cast<std::size_t>(headings_),
              0.0),
      work_(values_.size(), 0.0) {}

void PoseGrid::set_normal(double sigma_m, double sigma_rad) {
  std::fill(values_.begin(), values_.end(), 0.0);
  values_[index(side_ / 2, side_ / 2, headings_ / 2)] = 1.0;
  blur(sigma_m, sigma_rad);
  normalize();
}

void PoseGrid::set_uniform() {
  std::fill(values_.begin(), values_.end(), 1.0 / static_cast<double>(values_.size()));
}

void PoseGrid::drive(const Eigen::Vector2d& step_m) {
  const auto layer_cells = static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
  std::fill(work_.begin(), work_.end(), 0.0);
  for (int h = 0; h < headings_; ++h) {
    const geometry::SinCos turn = geometry::sincos(offset_rad(h));
    const double dx = ((turn.cos - 1.0) * step_m.x() - turn.sin * step_m.y()) / cell_m_;
    const double dy = (turn.sin * step_m.x() + (turn.cos - 1.0) * step_m.y()) / cell_m_;
    const int whole_x = static_cast<int>(std::floor(dx));
    const int whole_y = static_cast<int>(std::floor(dy));
    const double part_x = dx - whole_x;
    const double part_y = dy - whole_y;
    const double* from = values_.data() + static_cast<std::size_t>(h) * layer_cells;
    for (int y = 0; y < side_; ++y) {
      for (int x = 0; x < side_; ++x, ++from) {
        if (*from == 0.0) continue;
        for (int k = 0; k < 4; ++k) {
          const int to_x = x + whole_x + (k & 1);
          const int to_y = y + whole_y + (k >> 1);
          if (to_x < 0 || to_y < 0 || to_x >= side_ || to_y >= side_) continue;
          const double share =
              ((k & 1) != 0 ? part_x : 1.0 - part_x) * ((k >> 1) != 0 ? part_y : 1.0 - part_y);
          work_[index(to_x, to_y, h)] += share * *from;
        }
      }
    }
  }
  values_.swap(work_);
}

void PoseGrid::blur_along(std::size_t stride, int length, double sigma_cells) {
  constexpr double kNone = 1e-3;
  constexpr double kTail = 3.0;
  if (sigma_cells < kNone) return;
  // For a few cells: weights with this variance; for more: those of the normal distribution.
  const int reach = std::max(1, static_cast<int>(std::ceil(kTail * sigma_cells)));
  std::vector<double> weights(static_cast<std::size_t>(reach) + 1);
  constexpr double kFewCells = 0.6;
  if (sigma_cells < kFewCells) {
    weights.assign({1.0 - sigma_cells * sigma_cells, 0.5 * sigma_cells * sigma_cells});
  } else {
    double sum = 0.0;
    for (int k = 0; k <= reach; ++k) {
      const double weight = geometry::exp(-0.5 * k * k / (sigma_cells * sigma_cells));
      weights[static_cast<std::size_t>(k)] = weight;
      sum += k == 0 ? weight : 2.0 * weight;
    }
    for (double& weight : weights) weight /= sum;
  }
  std::fill(work_.begin(), work_.end(), 0.0);
  const auto most = static_cast<int>(weights.size()) - 1;
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const double value = values_[i];
    if (value == 0.0) continue;
    const auto at = static_cast<int>(i / stride % static_cast<std::size_t>(length));
    for (int k = -std::min(most, at); k <= std::min(most, length - 1 - at); ++k) {
      const auto to = static_cast<std::ptrdiff_t>(i) + k * static_cast<std::ptrdiff_t>(stride);
      work_[static_cast<std::size_t>(to)] += weights[static_cast<std::size_t>(std::abs(k))] * value;
    }
  }
  values_.swap(work_);
}

void PoseGrid::blur(double sigma_m, double sigma_rad) {
  const auto side = static_cast<std::size_t>(side_);
  blur_along(1, side_, sigma_m / cell_m_);
  blur_along(side, side_, sigma_m / cell_m_);
  blur_along(side * side, headings_, sigma_rad / heading_step_rad_);
}

void PoseGrid::shift(int by_x, int by_y, int by_heading) {
  std::fill(work_.begin(), work_.end(), 0.0);
  for (int h = std::max(0, -by_heading); h < headings_ - std::max(0, by_heading); ++h) {
    for (int y = std::max(0, -by_y); y < side_ - std::max(0, by_y); ++y) {
      for (int x = std::max(0, -by_x); x < side_ - std::max(0, by_x); ++x) {
        work_[index(x + by_x, y + by_y, h + by_heading)] = values_[index(x, y, h)];
      }
    }
  }
  values_.swap(work_);
}

bool PoseGrid::normalize() {
  constexpr double kNegligible = 1e-7;  // of the largest
  double most = 0.0;
  for (const double value : values_) most = std::max(most, value);
  if (!(most > 0.0)) return false;
  double sum = 0.0;
  for (double& value : values_) {
    if (value < kNegligible * most) value = 0.0;
    sum += value;
  }
  for (double& value : values_) value /= sum;
  return true;
}

PoseGrid::Moments PoseGrid::moments() const {
  Moments moments;
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  std::size_t i = 0;
  for (int h = 0; h < headings_; ++h) {
    for (int y = 0; y < side_; ++y) {
      for (int x = 0; x < side_; ++x, ++i) {
        if (values_[i] == 0.0) continue;
        const Eigen::Vector3d offset(offset_m(x), offset_m(y), offset_rad(h));
        moments.mean += values_[i] * offset;
        square += values_[i] * offset * offset.transpose();
      }
    }
  }
  moments.covariance = square - moments.mean * moments.mean.transpose();
  return moments;
}

}  // namespace topogeo::markov
