// A rectangle of the page that shows a part of the robot's surroundings: x (forward) up, y (left)
// to the left, equal scale.
#pragma once

#include <Eigen/Core>
#include <cairo.h>

#include "topogeo/render/scan_view.hpp"

#include "rect.hpp"

namespace topogeo::render {

struct Extent {
  Eigen::Vector2d min_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d max_m = Eigen::Vector2d::Zero();
  void add(const Eigen::Vector2d& point_m) {
    min_m = min_m.cwiseMin(point_m);
    max_m = max_m.cwiseMax(point_m);
  }
};

/// Visible extent of a view, robot frame: the robot, the points within the range limit, virtual
/// groups and branches, with a border. At least 2 m a side.
Extent extent_of(const ScanView& view);

struct PlanFrame {
  Rect rect_px;
  Eigen::Vector2d max_m = Eigen::Vector2d::Zero();  ///< at the top left corner
  double scale_px_per_m = 1.0;

  [[nodiscard]] Eigen::Vector2d to_px(const Eigen::Vector2d& point_m) const {
    return {rect_px.left + (max_m.y() - point_m.y()) * scale_px_per_m,
            rect_px.top + (max_m.x() - point_m.x()) * scale_px_per_m};
  }
  [[nodiscard]] Eigen::Vector2d min_m() const {
    return max_m - Eigen::Vector2d(rect_px.height, rect_px.width) / scale_px_per_m;
  }
};

/// Fits the extent into the middle of the rectangle, as large as possible, at most `most_px_per_m`.
PlanFrame fit(const Extent& extent, const Rect& rect_px, double most_px_per_m);

/// Clips everything outside the rectangle, until cairo_restore.
void clip_to(cairo_t* cr, const Rect& rect);

/// Grid lines and axes in metres ("x forward", "y left"), left of and below the rectangle.
void draw_plan_axes(cairo_t* cr, const PlanFrame& frame);

}  // namespace topogeo::render
