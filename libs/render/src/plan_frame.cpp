#include "plan_frame.hpp"

#include <algorithm>

#include "axes.hpp"

namespace topogeo::render {

Extent extent_of(const ScanView& view) {
  Extent extent;
  for (const topomap::ScanPoint& p : view.map.points) extent.add({p.x_m, p.y_m});
  for (const voronoi::GroupPoint& p : view.diagram.groups.points) {
    extent.add(view.map.T_robot_laser * p.position_m);
  }
  for (const topomap::LocalBranch& branch : view.map.branches) {
    for (const topomap::BranchPoint& p : branch.points) extent.add(p.position_m);
  }
  constexpr double kBorder_m = 0.35;
  constexpr double kLeast_m = 2.0;
  const Eigen::Vector2d size_m = extent.max_m - extent.min_m;
  const Eigen::Vector2d more_m = (0.5 * (kLeast_m - size_m.array())).max(kBorder_m);
  extent.min_m -= more_m;
  extent.max_m += more_m;
  return extent;
}

PlanFrame fit(const Extent& extent, const Rect& rect_px, double most_px_per_m) {
  const Eigen::Vector2d size_m = extent.max_m - extent.min_m;
  PlanFrame frame;
  frame.rect_px = rect_px;
  frame.scale_px_per_m =
      std::min({most_px_per_m, rect_px.height / size_m.x(), rect_px.width / size_m.y()});
  const Eigen::Vector2d shown_m =
      Eigen::Vector2d(rect_px.height, rect_px.width) / frame.scale_px_per_m;
  frame.max_m = 0.5 * (extent.min_m + extent.max_m + shown_m);
  return frame;
}

void clip_to(cairo_t* cr, const Rect& rect) {
  cairo_rectangle(cr, rect.left, rect.top, rect.width, rect.height);
  cairo_clip(cr);
}

void draw_plan_axes(cairo_t* cr, const PlanFrame& frame) {
  const Rect& rect = frame.rect_px;
  const Eigen::Vector2d min_m = frame.min_m();
  const double step_m = tick_step(std::max(rect.width, rect.height) / frame.scale_px_per_m, 16.0);
  for_each_tick(min_m.x(), frame.max_m.x(), step_m, [&](double x_m) {
    draw_tick_up(cr, rect, frame.to_px({x_m, 0.0}).y(), x_m);
  });
  for_each_tick(min_m.y(), frame.max_m.y(), step_m, [&](double y_m) {
    draw_tick_across(cr, rect, frame.to_px({0.0, y_m}).x(), y_m);
  });
  draw_axis_names(cr, rect, "y left (m)", "x forward (m)");
}

}  // namespace topogeo::render
