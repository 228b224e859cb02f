#include "topogeo/render/match_picture.hpp"

#include <cmath>
#include <numbers>

#include "topogeo/geometry/portable_math.hpp"

#include "axes.hpp"
#include "canvas.hpp"
#include "labels.hpp"
#include "page.hpp"
#include "plan_frame.hpp"

namespace topogeo::render {
namespace {

using geometry::Pose2;
using topomap::LocalMap;

// Sizes and colours on the page, chosen by eye.
constexpr double kMatchMargin_px = 20.0;
constexpr double kMatchHeader_px = 66.0;
constexpr double kMatchLine_px = 18.0;
constexpr double kMatchScale_px = 240.0;  // of one metre
constexpr double kMatchPoint_px = 2.5;
constexpr double kMatchBranch_px = 2.0;

struct MatchPanels {
  Rect maps;
  Rect search;
  double lines_top = 0.0;
  std::uint32_t height_px = 0;
};

MatchPanels arrange_match(const MatchPicture& picture, double width_px) {
  const double side_px = 0.5 * (width_px - 3 * kMatchMargin_px) - kAxisLeft_px;
  const double left_px = kMatchMargin_px + kAxisLeft_px;
  MatchPanels panels;
  panels.maps = {left_px, kMatchHeader_px, side_px, side_px};
  panels.search = {left_px + side_px + kMatchMargin_px + kAxisLeft_px, kMatchHeader_px, side_px,
                   side_px};
  panels.lines_top = panels.maps.bottom() + kAxisBelow_px + kMatchMargin_px;
  const double lines_px = kMatchLine_px * static_cast<double>(picture.lines.size());
  panels.height_px =
      static_cast<std::uint32_t>(std::ceil(panels.lines_top + lines_px + kMatchMargin_px));
  return panels;
}

/// Adds a border.
Extent with_border(Extent extent, double least_m) {
  const Eigen::Vector2d border_m = (0.06 * (extent.max_m - extent.min_m)).cwiseMax(least_m);
  extent.min_m -= border_m;
  extent.max_m += border_m;
  return extent;
}

Pose2 shown_pose(const MatchPicture& picture) {
  return picture.found ? picture.T_found : picture.T_predicted;
}

Extent extent_of_maps(const MatchPicture& picture) {
  Extent extent;
  for (const topomap::ScanPoint& p : picture.reference->points) extent.add({p.x_m, p.y_m});
  const Pose2 T = shown_pose(picture);
  for (const topomap::ScanPoint& p : picture.query->points) {
    extent.add(T * Eigen::Vector2d(p.x_m, p.y_m));
  }
  return with_border(extent, 0.5);
}

Extent extent_of_search(const MatchPicture& picture) {
  const Eigen::Vector2d centre_m = picture.T_predicted.position_m();
  Extent extent{centre_m - picture.half_width_m, centre_m + picture.half_width_m};
  for (const Pose2& T : picture.solutions) extent.add(T.position_m());
  if (picture.found) extent.add(picture.T_found.position_m());
  return with_border(extent, 0.1);
}

// The visible area, from the robot through the points in the order of the beams.
void draw_field_of_view(cairo_t* cr, const LocalMap& map, const PlanFrame& frame) {
  if (map.points.empty()) return;
  set_colour(cr, kFreeSpace);
  move_to(cr, frame.to_px(map.T_robot_laser.position_m()));
  for (const topomap::ScanPoint& p : map.points) line_to(cr, frame.to_px({p.x_m, p.y_m}));
  cairo_close_path(cr);
  cairo_fill(cr);
}

void draw_map(cairo_t* cr, const LocalMap& map, const Pose2& T, const PlanFrame& frame,
              const Colour& points, const Colour& branches) {
  set_colour(cr, points);
  for (const topomap::ScanPoint& p : map.points) {
    const Eigen::Vector2d px = frame.to_px(T * Eigen::Vector2d(p.x_m, p.y_m));
    cairo_rectangle(cr, snapped(px.x() - 0.5 * kMatchPoint_px),
                    snapped(px.y() - 0.5 * kMatchPoint_px), kMatchPoint_px, kMatchPoint_px);
  }
  cairo_fill(cr);
  cairo_set_line_width(cr, kMatchBranch_px);
  for (const topomap::LocalBranch& branch : map.branches) {
    set_colour(cr, paled(branches, branch.in_main_graph ? 1.0 : 0.4));
    set_dashes(cr, branch.is_virtual);
    for (const topomap::BranchPoint& p : branch.points) line_to(cr, frame.to_px(T * p.position_m));
    cairo_stroke(cr);
  }
  set_dashes(cr, false);
  for (const topomap::LocalNode& node : map.nodes) {
    draw_node_marker(cr, node.kind, frame.to_px(T * node.position_m),
                     node.in_main_graph ? 1.0 : 0.4);
  }
}

void draw_robot(cairo_t* cr, const Pose2& T, const PlanFrame& frame) {
  cairo_save(cr);
  const Eigen::Vector2d px = frame.to_px(T.position_m());
  cairo_translate(cr, px.x(), px.y());
  cairo_rotate(cr, -T.theta_rad);
  draw_robot_marker(cr, Eigen::Vector2d::Zero(), 1.0);
  cairo_restore(cr);
}

void draw_searched(cairo_t* cr, const MatchPicture& picture, const PlanFrame& frame) {
  const Eigen::Vector2d centre_m = picture.T_predicted.position_m();
  const Eigen::Vector2d corner_px = frame.to_px(centre_m + picture.half_width_m);
  const Eigen::Vector2d size_px = 2.0 * frame.scale_px_per_m * picture.half_width_m;
  set_colour(cr, kOdometry);
  cairo_set_line_width(cr, 1.5);
  set_dashes(cr, true);
  cairo_rectangle(cr, corner_px.x(), corner_px.y(), size_px.y(), size_px.x());
  cairo_stroke(cr);
  set_dashes(cr, false);
  constexpr int kCorners = 72;
  const geometry::SinCos axis = geometry::sincos(picture.ellipse_direction_rad);
  for (int i = 0; i < kCorners; ++i) {
    const geometry::SinCos turn = geometry::sincos(2.0 * std::numbers::pi * i / kCorners);
    const double along_m = picture.ellipse_major_m * turn.cos;
    const double across_m = picture.ellipse_minor_m * turn.sin;
    line_to(cr, frame.to_px(centre_m + Eigen::Vector2d(axis.cos * along_m - axis.sin * across_m,
                                                       axis.sin * along_m + axis.cos * across_m)));
  }
  cairo_close_path(cr);
  cairo_stroke(cr);
}

void draw_maps_panel(cairo_t* cr, const MatchPicture& picture, const Rect& rect) {
  const PlanFrame frame = fit(extent_of_maps(picture), rect, kMatchScale_px);
  draw_plan_axes(cr, frame);
  cairo_save(cr);
  clip_to(cr, rect);
  draw_field_of_view(cr, *picture.reference, frame);
  draw_map(cr, *picture.reference, {}, frame, kLaserPoints, kDiagramBranch);
  draw_map(cr, *picture.query, shown_pose(picture), frame, kCorrected, kBranch);
  draw_searched(cr, picture, frame);
  draw_robot(cr, {}, frame);
  draw_robot(cr, shown_pose(picture), frame);
  cairo_restore(cr);
  draw_border(cr, rect);
}

// A line from each pose shows its heading.
void draw_pose(cairo_t* cr, const Pose2& T, const PlanFrame& frame, const Colour& colour,
               double radius_px) {
  constexpr double kHeading_px = 22.0;
  const geometry::SinCos heading = geometry::sincos(T.theta_rad);
  const Eigen::Vector2d at_px = frame.to_px(T.position_m());
  set_colour(cr, colour);
  cairo_set_line_width(cr, 1.5);
  move_to(cr, at_px);
  line_to(cr, at_px - kHeading_px * Eigen::Vector2d(heading.sin, heading.cos));
  cairo_stroke(cr);
  circle(cr, at_px, radius_px);
  fill_and_edge(cr, colour, kWhite, 1.0);
}

void draw_search_panel(cairo_t* cr, const MatchPicture& picture, const Rect& rect) {
  const PlanFrame frame = fit(extent_of_search(picture), rect, 40.0 * kMatchScale_px);
  draw_plan_axes(cr, frame);
  cairo_save(cr);
  clip_to(cr, rect);
  draw_searched(cr, picture, frame);
  draw_pose(cr, picture.T_predicted, frame, kOdometry, 5.0);
  Labels labels;
  for (std::size_t i = picture.solutions.size(); i-- > 0;) {
    draw_pose(cr, picture.solutions[i], frame, kBranch, 4.0);
  }
  if (picture.found) draw_pose(cr, picture.T_found, frame, kCorrected, 5.0);
  set_colour(cr, kInk);
  for (std::size_t i = 0; i < picture.solutions.size(); ++i) {
    labels.draw(cr, std::to_string(i + 1), frame.to_px(picture.solutions[i].position_m()), 7.0,
                12.0, rect, true);
  }
  cairo_restore(cr);
  draw_border(cr, rect);
}

}  // namespace

std::string match_picture(const MatchPicture& picture, PictureFormat format,
                          const PictureOptions& options) {
  check(options);
  const MatchPanels panels = arrange_match(picture, options.max_width_px);
  return draw_page(format, options.max_width_px, panels.height_px, [&](cairo_t* cr) {
    start_page(cr);
    set_colour(cr, kInk);
    draw_text(cr, picture.title, kMatchMargin_px, 28.0, 18.0);
    draw_text(
        cr,
        "Left: reference grey and green, field of view pale; query red and blue, where it was "
        "found. Right: rectangle and ellipse of the prediction (orange), solutions (blue), "
        "refined pose (red).",
        kMatchMargin_px, 50.0, 12.0);
    draw_maps_panel(cr, picture, panels.maps);
    draw_search_panel(cr, picture, panels.search);
    set_colour(cr, kInk);
    for (std::size_t i = 0; i < picture.lines.size(); ++i) {
      draw_text(cr, picture.lines[i], kMatchMargin_px,
                panels.lines_top + kMatchLine_px * static_cast<double>(i), 13.0);
    }
  });
}

}  // namespace topogeo::render
