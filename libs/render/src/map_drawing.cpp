#include "map_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>
#include <utility>

#include "canvas.hpp"
#include "legend.hpp"
#include "point_raster.hpp"

namespace topogeo::render {
namespace {

/// A quarter of a pixel: finer steps cannot be seen but make the numbers in an SVG longer.
double snapped(double value_px) {
  return std::round(value_px * 4.0) / 4.0;
}

void move_to(cairo_t* cr, const Eigen::Vector2d& p) {
  cairo_move_to(cr, snapped(p.x()), snapped(p.y()));
}
void line_to(cairo_t* cr, const Eigen::Vector2d& p) {
  cairo_line_to(cr, snapped(p.x()), snapped(p.y()));
}

void draw_laser_points(cairo_t* cr, const std::vector<ScanOutline>& outlines,
                       const Layout& layout) {
  constexpr double kFinestCell_m = 0.03;
  const double cell_m = std::max(kFinestCell_m, 1.0 / layout.scale_px_per_m);
  set_colour(cr, kLaserPoints);
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_BUTT);
  cairo_set_line_width(cr, std::clamp(cell_m * layout.scale_px_per_m, 1.25, 2.5));
  for (const RasterRun& run : raster_runs(outlines, layout, cell_m)) {
    move_to(cr, layout.turned_to_px(run.from_m));
    line_to(cr, layout.turned_to_px(run.to_m));
  }
  cairo_stroke(cr);
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
}

void draw_path(cairo_t* cr, std::span<const topomap::StampedPose> poses, const Layout& layout,
               const Colour& colour, double width_px) {
  if (poses.empty()) return;
  set_colour(cr, colour);
  cairo_set_line_width(cr, width_px);
  Eigen::Vector2d last_px = layout.to_px(poses.front().pose.position_m());
  move_to(cr, last_px);
  for (const topomap::StampedPose& p : poses) {
    const Eigen::Vector2d point_px = layout.to_px(p.pose.position_m());
    if ((point_px - last_px).norm() < 1.0) continue;  // a robot that stands still
    line_to(cr, point_px);
    last_px = point_px;
  }
  cairo_stroke(cr);
}

void draw_branches(cairo_t* cr, const topomap::GlobalMap& map, const Layout& layout) {
  cairo_set_line_width(cr, 2.0);
  for (const topomap::MapBranch& branch : map.branches) {
    if (branch.points.empty()) continue;
    set_colour(cr, branch.is_virtual ? kVirtualBranch : kBranch);
    set_dashes(cr, branch.is_virtual);
    Eigen::Vector2d last_px = layout.to_px(branch.points.front().position_m);
    move_to(cr, last_px);
    for (std::size_t i = 1; i < branch.points.size(); ++i) {
      const Eigen::Vector2d point_px = layout.to_px(branch.points[i].position_m);
      const bool is_end = i + 1 == branch.points.size();
      if (!is_end && (point_px - last_px).norm() < 1.0) continue;
      line_to(cr, point_px);
      last_px = point_px;
    }
    cairo_stroke(cr);
  }
  set_dashes(cr, false);
}

// One line for all closures between the same two stretches of the way: a corridor driven twice has
// hundreds, and drawn all they would hide the map.
void draw_loop_closures(cairo_t* cr, const MapPicture& picture, const Layout& layout) {
  constexpr std::uint32_t kStretch_stops = 8;
  std::set<std::pair<std::uint32_t, std::uint32_t>> drawn;
  set_colour(cr, kLoopClosure);
  cairo_set_line_width(cr, 0.75);
  for (const topomap::LoopClosure& closure : picture.loop_closures) {
    if (std::max(closure.earlier_id, closure.later_id) >= picture.stops.size()) continue;
    const auto stretches =
        std::pair(closure.earlier_id / kStretch_stops, closure.later_id / kStretch_stops);
    if (!drawn.insert(stretches).second) continue;
    move_to(cr, layout.to_px(picture.stops[closure.earlier_id].T_map_robot.position_m()));
    line_to(cr, layout.to_px(picture.stops[closure.later_id].T_map_robot.position_m()));
  }
  cairo_stroke(cr);
}

void draw_nodes(cairo_t* cr, const topomap::GlobalMap& map, const Layout& layout) {
  for (const topomap::MapNode& node : map.nodes) {
    const Eigen::Vector2d centre_px = layout.to_px(node.position_m);
    draw_node_marker(cr, node.kind, {snapped(centre_px.x()), snapped(centre_px.y())});
  }
}

void polygon(cairo_t* cr, const Eigen::Vector2d& centre_px, double radius_px, int corners,
             double first_rad) {
  for (int i = 0; i < corners; ++i) {
    const double angle_rad = first_rad + 2.0 * std::numbers::pi * i / corners;
    cairo_line_to(cr, centre_px.x() + radius_px * std::cos(angle_rad),
                  centre_px.y() - radius_px * std::sin(angle_rad));
  }
  cairo_close_path(cr);
}

void circle(cairo_t* cr, const Eigen::Vector2d& centre_px, double radius_px) {
  cairo_new_sub_path(cr);
  cairo_arc(cr, centre_px.x(), centre_px.y(), radius_px, 0.0, 2.0 * std::numbers::pi);
}

void fill_and_edge(cairo_t* cr, const Colour& fill, const Colour& edge, double edge_px) {
  set_colour(cr, fill);
  cairo_fill_preserve(cr);
  set_colour(cr, edge);
  cairo_set_line_width(cr, edge_px);
  cairo_stroke(cr);
}

void set_plain_text(cairo_t* cr) {
  // No colour fringes and no fitting to the pixels of one screen, whatever the machine is set to.
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(cr, options);
  cairo_font_options_destroy(options);
}

void draw_title(cairo_t* cr, const MapPicture& picture, const Layout& layout) {
  set_colour(cr, kInk);
  constexpr double kTitleSize_px = 18.0;
  draw_text(cr, picture.title, 24.0, 28.0, kTitleSize_px);
  if (picture.stops.empty() && picture.corrected.empty()) {
    draw_text(cr, "nothing mapped yet", layout.map_left_px, layout.map_top_px + 20.0, 14.0);
  }
}

}  // namespace

void draw_text(cairo_t* cr, const std::string& text, double x_px, double y_px, double size_px) {
  cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cr, size_px);
  cairo_move_to(cr, x_px, y_px);
  cairo_show_text(cr, text.c_str());
  cairo_new_path(cr);
}

double text_width_px(cairo_t* cr, const std::string& text, double size_px) {
  cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cr, size_px);
  cairo_text_extents_t extents{};
  cairo_text_extents(cr, text.c_str(), &extents);
  return extents.x_advance;
}

void draw_node_marker(cairo_t* cr, topomap::NodeKind kind, const Eigen::Vector2d& centre_px) {
  constexpr double kUp_rad = std::numbers::pi / 2;
  switch (kind) {
    case topomap::NodeKind::kReal:
      circle(cr, centre_px, 4.0);
      fill_and_edge(cr, kBranch, kWhite, 1.0);
      break;
    case topomap::NodeKind::kFictitious:
      circle(cr, centre_px, 3.0);
      fill_and_edge(cr, kWhite, kBranch, 1.25);
      break;
    case topomap::NodeKind::kVirtual:
      polygon(cr, centre_px, 4.5, 4, 0.0);
      fill_and_edge(cr, kVirtualBranch, kInk, 0.75);
      break;
    case topomap::NodeKind::kDoor:
      polygon(cr, centre_px, 6.5, 4, kUp_rad / 2);
      fill_and_edge(cr, kDoor, kWhite, 1.0);
      break;
    case topomap::NodeKind::kNarrowing:
      polygon(cr, centre_px, 6.0, 3, kUp_rad);
      fill_and_edge(cr, kOdometry, kInk, 0.75);
      break;
    case topomap::NodeKind::kHallCorridor:
      polygon(cr, centre_px, 5.5, 6, 0.0);
      fill_and_edge(cr, kWhite, kInk, 1.5);
      break;
  }
}

void draw_start_marker(cairo_t* cr, const Eigen::Vector2d& centre_px) {
  circle(cr, centre_px, 8.0);
  fill_and_edge(cr, kWhite, kInk, 2.0);
  circle(cr, centre_px, 3.5);
  set_colour(cr, kInk);
  cairo_fill(cr);
}

void draw_map(cairo_t* cr, const MapPicture& picture, const std::vector<ScanOutline>& outlines,
              const Layout& layout) {
  set_colour(cr, kWhite);
  cairo_paint(cr);
  set_plain_text(cr);
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
  cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);

  cairo_save(cr);
  cairo_rectangle(cr, layout.map_left_px, layout.map_top_px, layout.map_width_px,
                  layout.map_height_px);
  cairo_clip(cr);
  draw_laser_points(cr, outlines, layout);
  draw_path(cr, picture.odometry, layout, kOdometry, 1.5);
  if (picture.global_map != nullptr) draw_branches(cr, *picture.global_map, layout);
  draw_loop_closures(cr, picture, layout);
  draw_path(cr, picture.corrected, layout, kCorrected, 2.0);
  if (picture.global_map != nullptr) draw_nodes(cr, *picture.global_map, layout);
  if (!picture.corrected.empty()) {
    draw_start_marker(cr, layout.to_px(picture.corrected.front().pose.position_m()));
  }
  cairo_restore(cr);

  draw_title(cr, picture, layout);
  draw_legend(cr, picture, layout);
}

}  // namespace topogeo::render
