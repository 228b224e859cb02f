#include "topogeo/voronoi/nearest_site_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::voronoi {
namespace {

int cell_of(double coordinate_m, double resolution_m) {
  return static_cast<int>(std::floor(coordinate_m / resolution_m));
}

/// Beam nearest in angle to a point; beam count if the point is outside the field of view, which
/// ends half a step beyond the outer beams.
std::uint16_t beam_at(const BeamDirections& beams, double x_m, double y_m) {
  const std::size_t count = beams.directions().size();
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const double offset_rad =
      geometry::atan2(y_m, x_m) - beams.angle_min_rad() + 0.5 * beams.angle_step_rad();
  const double wrapped_rad = offset_rad - std::floor(offset_rad / kTurn) * kTurn;
  const auto beam = static_cast<std::size_t>(wrapped_rad / beams.angle_step_rad());
  if (beam == count && beams.closed()) return 0;
  return static_cast<std::uint16_t>(std::min(beam, count));
}

}  // namespace

void NearestSiteGrid::set_geometry(const BeamDirections& beams, const VoronoiConfig& config) {
  resolution_m_ = config.resolution_m;
  window_of_groups_ = config.window_of_groups;
  directions_ = beams.directions();
  low_x_ = high_x_ = low_y_ = high_y_ = 0;
  for (const Eigen::Vector2d& direction : beams.directions()) {
    const Eigen::Vector2d end = direction * config.range_limit_m;
    low_x_ = std::min(low_x_, cell_of(end.x(), resolution_m_));
    low_y_ = std::min(low_y_, cell_of(end.y(), resolution_m_));
    high_x_ = std::max(high_x_, cell_of(end.x(), resolution_m_) + 1);
    high_y_ = std::max(high_y_, cell_of(end.y(), resolution_m_) + 1);
  }
  beam_of_cell_.clear();
  beam_of_cell_.reserve(static_cast<std::size_t>(high_x_ - low_x_) *
                        static_cast<std::size_t>(high_y_ - low_y_));
  for (int ix = low_x_; ix < high_x_; ++ix) {
    for (int iy = low_y_; iy < high_y_; ++iy) {
      beam_of_cell_.push_back(
          beam_at(beams, (ix + 0.5) * resolution_m_, (iy + 0.5) * resolution_m_));
    }
  }
}

void NearestSiteGrid::set_window(std::span<const Site> sites,
                                 std::span<const double> free_range_m) {
  Eigen::Array2d low = sites.front().position_m.array();
  Eigen::Array2d high = low;
  for (const Site& site : sites) {
    low = low.min(site.position_m.array());
    high = high.max(site.position_m.array());
  }
  for (std::size_t i = 0; i < free_range_m.size() && !window_of_groups_; ++i) {
    const Eigen::Array2d end_m = directions_[i].array() * free_range_m[i];
    low = low.min(end_m);
    high = high.max(end_m);
  }
  first_x_ = std::max(low_x_, cell_of(low.x(), resolution_m_));
  first_y_ = std::max(low_y_, cell_of(low.y(), resolution_m_));
  rows_ = std::max(0, std::min(high_x_, cell_of(high.x(), resolution_m_) + 1) - first_x_);
  cols_ = std::max(0, std::min(high_y_, cell_of(high.y(), resolution_m_) + 1) - first_y_);
}

void NearestSiteGrid::compute(std::span<const Site> sites, std::span<const double> free_range_m) {
  rows_ = cols_ = 0;
  if (sites.empty()) return;
  if (sites.size() >= kNone) {
    throw std::invalid_argument("a diagram of " + std::to_string(sites.size()) +
                                " sites: at most 65534 are allowed");
  }
  set_window(sites, free_range_m);
  sites_.resize(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(cols_));
  groups_.resize(sites_.size());

  order_.resize(sites.size());
  for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<std::uint16_t>(i);
  std::sort(order_.begin(), order_.end(), [&](std::uint16_t a, std::uint16_t b) {
    const double ya = sites[a].position_m.y();
    const double yb = sites[b].position_m.y();
    return ya != yb ? ya < yb : a < b;
  });
  sorted_.clear();
  for (const std::uint16_t i : order_) sorted_.push_back(sites[i].position_m);
  free_sq_.clear();
  for (const double range_m : free_range_m) free_sq_.push_back(range_m * range_m);
  free_sq_.push_back(0.0);
  hull_.resize(sites.size());

  for (int row = 0; row < rows_; ++row) fill_row(row, sites);
}

void NearestSiteGrid::hull_of_row(double x_m) {
  std::size_t size = 0;
  hull_.resize(sorted_.size());
  for (std::size_t i = 0; i < sorted_.size(); ++i) {
    const double u = sorted_[i].y();
    const double dx = x_m - sorted_[i].x();
    const double f = u * u + dx * dx;
    if (size > 0 && hull_[size - 1].u == u) {
      if (f >= hull_[size - 1].f) continue;
      --size;
    }
    while (size >= 2 && (hull_[size - 1].f - hull_[size - 2].f) * (u - hull_[size - 2].u) >=
                            (f - hull_[size - 2].f) * (hull_[size - 1].u - hull_[size - 2].u)) {
      --size;
    }
    hull_[size++] = {u, f, order_[i]};
  }
  hull_.resize(size);
}

void NearestSiteGrid::fill_row(int row, std::span<const Site> sites) {
  const double x_m = (first_x_ + row + 0.5) * resolution_m_;
  const std::uint16_t* beam = &beam_of_cell_[static_cast<std::size_t>(first_x_ + row - low_x_) *
                                                 static_cast<std::size_t>(high_y_ - low_y_) +
                                             static_cast<std::size_t>(first_y_ - low_y_)];
  std::uint16_t* site_row = &sites_[index(row, 0)];
  std::uint16_t* group_row = &groups_[index(row, 0)];
  const auto visible = [&](int col) {
    const double y_m = (first_y_ + col + 0.5) * resolution_m_;
    return x_m * x_m + y_m * y_m < free_sq_[beam[col]];
  };
  std::fill(site_row, site_row + cols_, kNone);
  std::fill(group_row, group_row + cols_, kNone);
  int first = 0;
  while (first < cols_ && !visible(first)) ++first;
  int last = cols_;
  while (last > first && !visible(last - 1)) --last;
  if (first == last) return;

  hull_of_row(x_m);
  std::size_t k = 0;
  std::uint16_t group = sites[hull_[0].site].group;
  for (int col = first; col < last; ++col) {
    const double twice_y_m = (first_y_ + col + 0.5) * resolution_m_ * 2.0;
    while (k + 1 < hull_.size() &&
           hull_[k + 1].f - hull_[k].f < twice_y_m * (hull_[k + 1].u - hull_[k].u)) {
      ++k;
      group = sites[hull_[k].site].group;
    }
    if (!visible(col)) continue;
    site_row[col] = hull_[k].site;
    group_row[col] = group;
  }
}

}  // namespace topogeo::voronoi
