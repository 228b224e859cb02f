// Panels of the scan and its generator groups: polar, plan, diagram.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "axes.hpp"
#include "canvas.hpp"
#include "labels.hpp"
#include "scan_panels.hpp"

namespace topogeo::render {
namespace {

using voronoi::GroupPoint;
using voronoi::PointRun;

// Sizes and colours on the page, chosen by eye.
constexpr double kDot_px = 1.7;
constexpr double kNumber_px = 13.0;
constexpr double kDegree_rad = std::numbers::pi / 180.0;

/// Points of virtual groups are not readings.
bool is_reading(const ScanView& view, const GroupPoint& point) {
  return point.beam < view.scan.ranges_m.size() && view.scan.ranges_m[point.beam] == point.range_m;
}

void draw_dot(cairo_t* cr, const Eigen::Vector2d& at_px, bool filled) {
  circle(cr, {snapped(at_px.x()), snapped(at_px.y())}, kDot_px);
  cairo_set_line_width(cr, 0.8);
  filled ? cairo_fill(cr) : cairo_stroke(cr);
}

/// Draws all points of all groups; `to_px` takes a GroupPoint to the page.
template <typename ToPx>
void draw_group_points(cairo_t* cr, const ScanView& view, const ToPx& to_px) {
  const voronoi::GeneratorGroups& groups = view.diagram.groups;
  for (std::size_t group = 0; group < groups.groups.size(); ++group) {
    set_colour(cr, group_colour(group));
    for (std::uint32_t i = groups.groups[group].begin; i < groups.groups[group].end; ++i) {
      draw_dot(cr, to_px(groups.points[i]), is_reading(view, groups.points[i]));
    }
  }
}

/// Numbers the groups beside their middle points.
template <typename ToPx>
void draw_group_numbers(cairo_t* cr, const ScanView& view, const Rect& within, const ToPx& to_px) {
  const voronoi::GeneratorGroups& groups = view.diagram.groups;
  Labels labels;
  for (std::size_t i = 0; i < groups.points.size(); i += 2) {
    labels.block(to_px(groups.points[i]), kDot_px);
  }
  for (std::size_t group = 0; group < groups.groups.size(); ++group) {
    const PointRun& run = groups.groups[group];
    if (run.size() == 0) continue;
    set_colour(cr, group_colour(group));
    const Eigen::Vector2d at_px = to_px(groups.points[run.begin + run.size() / 2]);
    labels.draw(cr, std::to_string(group), at_px, 5.0, kNumber_px, within, true);
  }
}

/// Readings within the limit without a group.
std::vector<std::uint32_t> ungrouped_beams(const ScanView& view) {
  std::vector<bool> grouped(view.scan.ranges_m.size(), false);
  for (const PointRun& run : view.diagram.groups.groups) {
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      const GroupPoint& point = view.diagram.groups.points[i];
      if (is_reading(view, point)) grouped[point.beam] = true;
    }
  }
  std::vector<std::uint32_t> beams;
  for (std::uint32_t beam = 0; beam < grouped.size(); ++beam) {
    if (!grouped[beam] && voronoi::within_limit(view.scan.ranges_m[beam], view.voronoi)) {
      beams.push_back(beam);
    }
  }
  return beams;
}

double beam_angle_rad(const ScanView& view, std::size_t beam) {
  return view.scan.angle_min_rad + static_cast<double>(beam) * view.scan.angle_step_rad;
}

/// Point at a range along a beam, robot frame.
Eigen::Vector2d along_beam(const ScanView& view, std::size_t beam, double range_m) {
  const double angle_rad = beam_angle_rad(view, beam);
  return view.map.T_robot_laser *
         Eigen::Vector2d(range_m * std::cos(angle_rad), range_m * std::sin(angle_rad));
}

/// Scales of the polar plot.
struct PolarScale {
  Rect rect;
  double low_deg = 0.0;
  double high_deg = 1.0;
  double top_m = 1.0;

  PolarScale(const ScanView& view, const Rect& plot) : rect(plot) {
    const std::size_t beams = view.scan.ranges_m.size();
    low_deg = beam_angle_rad(view, 0) / kDegree_rad - 2.0;
    high_deg = beam_angle_rad(view, beams > 0 ? beams - 1 : 0) / kDegree_rad + 2.0;
    const double limit_m = view.voronoi.range_limit_m;
    double longest_m = 0.0;
    for (const float range_m : view.scan.ranges_m) {
      if (std::isfinite(range_m)) longest_m = std::max(longest_m, static_cast<double>(range_m));
    }
    top_m = std::clamp(1.05 * longest_m, 1.1 * limit_m, 1.6 * limit_m);
  }
  [[nodiscard]] double x_px(double angle_deg) const {
    return rect.left + (high_deg - angle_deg) / (high_deg - low_deg) * rect.width;
  }
  [[nodiscard]] double y_px(double range_m) const {
    return rect.bottom() - std::min(range_m / top_m, 1.0) * rect.height;
  }
};

/// Readings without a group, those beyond the limit and, on the base line, beams without an echo.
void draw_other_readings(cairo_t* cr, const ScanView& view, const PolarScale& scale) {
  set_colour(cr, kLaserPoints);
  const auto x_px = [&](std::size_t beam) {
    return scale.x_px(beam_angle_rad(view, beam) / kDegree_rad);
  };
  for (const std::uint32_t beam : ungrouped_beams(view)) {
    draw_dot(cr, {x_px(beam), scale.y_px(view.scan.ranges_m[beam])}, true);
  }
  for (std::size_t beam = 0; beam < view.scan.ranges_m.size(); ++beam) {
    const float range_m = view.scan.ranges_m[beam];
    if (voronoi::within_limit(range_m, view.voronoi)) continue;
    if (std::isfinite(range_m) && range_m > 0.0F) {
      draw_dot(cr, {x_px(beam), scale.y_px(range_m)}, true);
    } else {
      move_to(cr, {x_px(beam), scale.rect.bottom()});
      line_to(cr, {x_px(beam), scale.rect.bottom() - 6.0});
      cairo_set_line_width(cr, 1.0);
      cairo_stroke(cr);
    }
  }
}

/// The space proved free by the beams, as a soft fan.
void draw_free_space(cairo_t* cr, const ScanView& view, const PlanFrame& frame) {
  const Eigen::Vector2d laser_px = frame.to_px(view.map.T_robot_laser.position_m());
  const std::size_t count = std::min(view.free_range_m.size(), view.scan.ranges_m.size());
  set_colour(cr, kFreeSpace);
  move_to(cr, laser_px);
  for (std::size_t beam = 0; beam < count; ++beam) {
    line_to(cr, frame.to_px(along_beam(view, beam, view.free_range_m[beam])));
  }
  cairo_close_path(cr);
  cairo_fill(cr);
}

/// Draws the cells of each group as one path, to avoid seams between the rows.
void draw_cells(cairo_t* cr, const ScanView& view, const PlanFrame& frame) {
  constexpr double kStrength = 0.18;
  for (std::size_t group = 0; group < view.diagram.groups.groups.size(); ++group) {
    set_colour(cr, paled(group_colour(group), kStrength));
    for (const CellRun& run : view.cells) {
      if (run.group != group) continue;
      const std::array<Eigen::Vector2d, 4> corners{
          run.min_m, {run.max_m.x(), run.min_m.y()}, run.max_m, {run.min_m.x(), run.max_m.y()}};
      for (const Eigen::Vector2d& corner : corners) {
        const Eigen::Vector2d px = frame.to_px(view.map.T_robot_laser * corner);
        cairo_line_to(cr, std::round(px.x() * 20.0) / 20.0, std::round(px.y() * 20.0) / 20.0);
      }
      cairo_close_path(cr);
    }
    cairo_fill(cr);
  }
}

}  // namespace

Colour group_colour(std::size_t group) {
  // Strong enough for single dots on white, and different from the red of the robot.
  constexpr std::array<Colour, 8> kColours{{{0.90, 0.50, 0.00},
                                            {0.12, 0.47, 0.71},
                                            {0.58, 0.30, 0.74},
                                            {0.00, 0.62, 0.62},
                                            {0.89, 0.35, 0.70},
                                            {0.55, 0.34, 0.29},
                                            {0.60, 0.60, 0.05},
                                            {0.30, 0.30, 0.55}}};
  return kColours.at(group % kColours.size());
}

void draw_polar_panel(cairo_t* cr, const ScanView& view, const Rect& rect) {
  const PolarScale scale(view, rect);
  const double step_deg = scale.high_deg - scale.low_deg > 200.0 ? 45.0 : 30.0;
  for_each_tick(scale.low_deg, scale.high_deg, step_deg, [&](double angle_deg) {
    draw_tick_across(cr, rect, scale.x_px(angle_deg), angle_deg);
  });
  for_each_tick(0.0, scale.top_m, tick_step(scale.top_m, 10.0),
                [&](double range_m) { draw_tick_up(cr, rect, scale.y_px(range_m), range_m); });
  draw_axis_names(cr, rect, "beam angle (degrees, left positive)", "range (m)");

  set_colour(cr, kRangeLimit);
  cairo_set_line_width(cr, 1.5);
  set_dashes(cr, true);
  move_to(cr, {rect.left, scale.y_px(view.voronoi.range_limit_m)});
  line_to(cr, {rect.right(), scale.y_px(view.voronoi.range_limit_m)});
  cairo_stroke(cr);
  set_dashes(cr, false);

  draw_other_readings(cr, view, scale);
  const auto to_px = [&](const GroupPoint& point) {
    return Eigen::Vector2d(scale.x_px(beam_angle_rad(view, point.beam) / kDegree_rad),
                           scale.y_px(point.range_m));
  };
  draw_group_points(cr, view, to_px);
  draw_group_numbers(cr, view, rect, to_px);
  draw_border(cr, rect);
}

void draw_groups_panel(cairo_t* cr, const ScanView& view, const PlanFrame& frame) {
  draw_plan_axes(cr, frame);
  cairo_save(cr);
  clip_to(cr, frame.rect_px);
  draw_free_space(cr, view, frame);
  set_colour(cr, kLaserPoints);
  for (const std::uint32_t beam : ungrouped_beams(view)) {
    draw_dot(cr, frame.to_px(along_beam(view, beam, view.scan.ranges_m[beam])), true);
  }
  const auto to_px = [&](const GroupPoint& point) {
    return frame.to_px(view.map.T_robot_laser * point.position_m);
  };
  draw_group_points(cr, view, to_px);
  draw_robot_marker(cr, frame.to_px({0.0, 0.0}), 1.0);
  draw_group_numbers(cr, view, frame.rect_px, to_px);
  cairo_restore(cr);
  draw_border(cr, frame.rect_px);
}

void draw_diagram_panel(cairo_t* cr, const ScanView& view, const PlanFrame& frame) {
  draw_plan_axes(cr, frame);
  cairo_save(cr);
  clip_to(cr, frame.rect_px);
  draw_cells(cr, view, frame);
  const geometry::Pose2& T_robot_laser = view.map.T_robot_laser;
  draw_group_points(cr, view, [&](const GroupPoint& point) {
    return frame.to_px(T_robot_laser * point.position_m);
  });
  set_colour(cr, kDiagramNode);
  cairo_set_line_width(cr, 0.6);
  for (const voronoi::DiagramNode& node : view.diagram.nodes) {
    circle(cr, frame.to_px(T_robot_laser * node.position_m),
           node.clearance_m * frame.scale_px_per_m);
    cairo_stroke(cr);
  }
  set_colour(cr, kDiagramBranch);
  cairo_set_line_width(cr, 2.0);
  for (const voronoi::DiagramBranch& branch : view.diagram.branches) {
    for (const voronoi::DiagramPoint& point : view.diagram.points_of(branch)) {
      line_to(cr, frame.to_px(T_robot_laser * point.position_m));
    }
    cairo_stroke(cr);
  }
  set_colour(cr, kDiagramNode);
  for (const voronoi::DiagramNode& node : view.diagram.nodes) {
    circle(cr, frame.to_px(T_robot_laser * node.position_m), 3.5);
    cairo_fill(cr);
  }
  draw_robot_marker(cr, frame.to_px({0.0, 0.0}), 1.0);
  cairo_restore(cr);
  draw_border(cr, frame.rect_px);
}

}  // namespace topogeo::render
