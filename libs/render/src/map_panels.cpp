// Panels of the local topo-geometric map: plan and thumbnail.
#include <string>

#include "topogeo/support/format.hpp"

#include "axes.hpp"
#include "branch_style.hpp"
#include "canvas.hpp"
#include "labels.hpp"
#include "scan_panels.hpp"

namespace topogeo::render {
namespace {

using topomap::LocalBranch;
using topomap::LocalMap;
using topomap::LocalNode;

void draw_points(cairo_t* cr, const LocalMap& map, const PlanFrame& frame, double side_px) {
  set_colour(cr, kLaserPoints);
  for (const topomap::ScanPoint& point : map.points) {
    const Eigen::Vector2d px = frame.to_px({point.x_m, point.y_m});
    cairo_rectangle(cr, snapped(px.x() - 0.5 * side_px), snapped(px.y() - 0.5 * side_px), side_px,
                    side_px);
  }
  cairo_fill(cr);
}

void draw_panel_branches(cairo_t* cr, const LocalMap& map, const PlanFrame& frame,
                         double width_px) {
  for (const bool main : {false, true}) {  // the main graph on top
    for (const LocalBranch& branch : map.branches) {
      if (branch.in_main_graph != main) continue;
      set_branch_stroke(cr, branch, width_px);
      for (const topomap::BranchPoint& point : branch.points) {
        line_to(cr, frame.to_px(point.position_m));
      }
      cairo_stroke(cr);
    }
  }
  set_dashes(cr, false);
}

void draw_panel_nodes(cairo_t* cr, const LocalMap& map, const PlanFrame& frame) {
  for (const LocalNode& node : map.nodes) {
    const Eigen::Vector2d px = frame.to_px(node.position_m);
    draw_node_marker(cr, node.kind, {snapped(px.x()), snapped(px.y())},
                     strength(node.in_main_graph));
  }
}

void draw_numbers(cairo_t* cr, const LocalMap& map, const PlanFrame& frame) {
  constexpr double kNodeText_px = 12.0;
  constexpr double kBranchText_px = 10.0;
  Labels labels;
  for (const LocalNode& node : map.nodes) labels.block(frame.to_px(node.position_m), 5.0);
  for (const LocalNode& node : map.nodes) {
    set_colour(cr, node.in_main_graph ? kInk : kLaserPoints);
    labels.draw(cr, std::to_string(node.id), frame.to_px(node.position_m), 6.0, kNodeText_px,
                frame.rect_px, true);
  }
  for (const LocalBranch& branch : map.branches) {
    if (branch.points.empty()) continue;
    set_colour(cr, paled(kBranch, strength(branch.in_main_graph)));
    const Eigen::Vector2d middle_m = branch.points[branch.points.size() / 2].position_m;
    labels.draw(cr, fmt::format("b{}", branch.id), frame.to_px(middle_m), 4.0, kBranchText_px,
                frame.rect_px, false);
  }
}

}  // namespace

void draw_local_map_panel(cairo_t* cr, const ScanView& view, const PlanFrame& frame) {
  draw_plan_axes(cr, frame);
  cairo_save(cr);
  clip_to(cr, frame.rect_px);
  draw_points(cr, view.map, frame, 2.0);
  draw_panel_branches(cr, view.map, frame, 2.5);
  draw_robot_marker(cr, frame.to_px({0.0, 0.0}), 1.0);
  draw_panel_nodes(cr, view.map, frame);
  draw_numbers(cr, view.map, frame);
  cairo_restore(cr);
  draw_border(cr, frame.rect_px);
}

void draw_local_map_thumbnail(cairo_t* cr, const ScanView& view, const PlanFrame& frame) {
  cairo_save(cr);
  clip_to(cr, frame.rect_px);
  draw_points(cr, view.map, frame, 1.5);
  draw_panel_branches(cr, view.map, frame, 1.75);
  draw_robot_marker(cr, frame.to_px({0.0, 0.0}), 0.7);
  draw_panel_nodes(cr, view.map, frame);
  cairo_restore(cr);
}

}  // namespace topogeo::render
