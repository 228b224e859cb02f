// Panels of the local topo-geometric map: plan, thumbnail, clearance along the branches.
#include <algorithm>
#include <cmath>
#include <string>

#include <spdlog/fmt/fmt.h>

#include "axes.hpp"
#include "canvas.hpp"
#include "labels.hpp"
#include "scan_panels.hpp"

namespace topogeo::render {
namespace {

using topomap::LocalBranch;
using topomap::LocalMap;
using topomap::LocalNode;
using topomap::NodeKind;

constexpr double kPale = 0.35;  // strength of what is off the main graph

double strength(bool in_main_graph) {
  return in_main_graph ? 1.0 : kPale;
}

void draw_points(cairo_t* cr, const LocalMap& map, const PlanFrame& frame, double side_px) {
  set_colour(cr, kLaserPoints);
  for (const topomap::ScanPoint& point : map.points) {
    const Eigen::Vector2d px = frame.to_px({point.x_m, point.y_m});
    cairo_rectangle(cr, snapped(px.x() - 0.5 * side_px), snapped(px.y() - 0.5 * side_px), side_px,
                    side_px);
  }
  cairo_fill(cr);
}

void set_branch_stroke(cairo_t* cr, const LocalBranch& branch) {
  set_colour(cr,
             paled(branch.is_virtual ? kVirtualBranch : kBranch, strength(branch.in_main_graph)));
  set_dashes(cr, branch.is_virtual);
}

void draw_branches(cairo_t* cr, const LocalMap& map, const PlanFrame& frame, double width_px) {
  cairo_set_line_width(cr, width_px);
  for (const bool main : {false, true}) {  // the main graph on top
    for (const LocalBranch& branch : map.branches) {
      if (branch.in_main_graph != main) continue;
      set_branch_stroke(cr, branch);
      for (const topomap::BranchPoint& point : branch.points) {
        line_to(cr, frame.to_px(point.position_m));
      }
      cairo_stroke(cr);
    }
  }
  set_dashes(cr, false);
}

void draw_nodes(cairo_t* cr, const LocalMap& map, const PlanFrame& frame) {
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

void clip_to(cairo_t* cr, const Rect& rect) {
  cairo_rectangle(cr, rect.left, rect.top, rect.width, rect.height);
  cairo_clip(cr);
}

/// Distance of each point from the first along the branch.
std::vector<double> arc_lengths_m(const LocalBranch& branch) {
  std::vector<double> arc_m(branch.points.size(), 0.0);
  for (std::size_t i = 1; i < arc_m.size(); ++i) {
    arc_m[i] =
        arc_m[i - 1] + (branch.points[i].position_m - branch.points[i - 1].position_m).norm();
  }
  return arc_m;
}

/// True if branch i + 1 is the next piece of the curve that branch i is a piece of.
bool continues(const LocalMap& map, std::size_t i) {
  if (i + 1 >= map.branches.size()) return false;
  const LocalBranch& piece = map.branches[i];
  const LocalBranch& next = map.branches[i + 1];
  return piece.node_b == next.node_a && piece.node_b < map.nodes.size() &&
         map.nodes[piece.node_b].kind != NodeKind::kReal && piece.base_groups == next.base_groups;
}

/// Places of the branches beside each other and scales of the clearance plot.
struct ClearancePlot {
  Rect rect;
  std::vector<std::vector<double>> arc_m;  ///< per branch
  std::vector<double> left_px;             ///< per branch
  double scale_px_per_m = 1.0;
  double top_m = 1.0;

  ClearancePlot(const ScanView& view, const Rect& plot) : rect(plot) {
    constexpr double kGap_px = 12.0;
    constexpr double kLargest_px_per_m = 120.0;
    const LocalMap& map = view.map;
    double total_m = 0.0;
    int gaps = 1;
    top_m = view.local_map.door_half_width_m;
    for (std::size_t i = 0; i < map.branches.size(); ++i) {
      arc_m.push_back(arc_lengths_m(map.branches[i]));
      if (!arc_m.back().empty()) total_m += arc_m.back().back();
      if (!continues(map, i)) ++gaps;
      for (const auto& point : map.branches[i].points) top_m = std::max(top_m, point.clearance_m);
    }
    top_m *= 1.15;
    scale_px_per_m = std::min(kLargest_px_per_m,
                              std::max(1.0, rect.width - gaps * kGap_px) / std::max(total_m, 0.1));
    double x_px = rect.left + kGap_px;
    for (std::size_t i = 0; i < map.branches.size(); ++i) {
      left_px.push_back(x_px);
      if (!arc_m[i].empty()) x_px += arc_m[i].back() * scale_px_per_m;
      if (!continues(map, i)) x_px += kGap_px;
    }
  }
  [[nodiscard]] double y_px(double clearance_m) const {
    return rect.bottom() - clearance_m / top_m * rect.height;
  }
  [[nodiscard]] Eigen::Vector2d to_px(std::size_t branch, std::size_t point,
                                      double clearance_m) const {
    return {left_px[branch] + arc_m[branch][point] * scale_px_per_m, y_px(clearance_m)};
  }
};

void draw_clearance_lines(cairo_t* cr, const LocalMap& map, const ClearancePlot& plot) {
  cairo_set_line_width(cr, 1.5);
  for (std::size_t i = 0; i < map.branches.size(); ++i) {
    const LocalBranch& branch = map.branches[i];
    set_branch_stroke(cr, branch);
    for (std::size_t k = 0; k < branch.points.size(); ++k) {
      line_to(cr, plot.to_px(i, k, branch.points[k].clearance_m));
    }
    cairo_stroke(cr);
  }
  set_dashes(cr, false);
}

void draw_clearance_nodes(cairo_t* cr, const LocalMap& map, const ClearancePlot& plot) {
  constexpr double kText_px = 10.0;
  Labels labels;
  const auto draw_node = [&](std::uint32_t id, const Eigen::Vector2d& px) {
    if (id >= map.nodes.size()) return;
    const LocalNode& node = map.nodes[id];
    draw_node_marker(cr, node.kind, {snapped(px.x()), snapped(px.y())},
                     strength(node.in_main_graph));
    labels.block(px, 5.0);
    set_colour(cr, node.in_main_graph ? kInk : kLaserPoints);
    labels.draw(cr, std::to_string(id), px, 6.0, kText_px, plot.rect, false);
  };
  for (std::size_t i = 0; i < map.branches.size(); ++i) {
    const LocalBranch& branch = map.branches[i];
    if (branch.points.empty()) continue;
    const std::size_t last = branch.points.size() - 1;
    if (i == 0 || !continues(map, i - 1)) {
      draw_node(branch.node_a, plot.to_px(i, 0, branch.points.front().clearance_m));
    }
    draw_node(branch.node_b, plot.to_px(i, last, branch.points[last].clearance_m));
  }
  for (std::size_t i = 0; i < map.branches.size(); ++i) {
    const LocalBranch& branch = map.branches[i];
    if (branch.points.empty()) continue;
    set_colour(cr, paled(kBranch, strength(branch.in_main_graph)));
    const double x_px = plot.left_px[i] + 0.5 * plot.arc_m[i].back() * plot.scale_px_per_m;
    labels.draw(cr, fmt::format("b{}", branch.id), {x_px, plot.rect.bottom() - 8.0}, 0.0, kText_px,
                plot.rect, false);
  }
}

LegendItem group_item() {
  return {"generator groups", [](cairo_t* cr, const Eigen::Vector2d& centre_px) {
            for (int i = 0; i < 4; ++i) {
              set_colour(cr, group_colour(static_cast<std::size_t>(i)));
              circle(cr, {centre_px.x() + 6.0 * i - 9.0, centre_px.y()}, 1.9);
              cairo_fill(cr);
            }
          }};
}

LegendItem circle_item() {
  return {"clearance of a node", [](cairo_t* cr, const Eigen::Vector2d& centre_px) {
            set_colour(cr, kDiagramNode);
            circle(cr, centre_px, 3.0);
            cairo_fill(cr);
            cairo_set_line_width(cr, 0.6);
            circle(cr, centre_px, 8.0);
            cairo_stroke(cr);
          }};
}

LegendItem dot_item() {
  return {"reading in no group (beyond the limit: above the line; no echo: tick)",
          [](cairo_t* cr, const Eigen::Vector2d& centre_px) {
            set_colour(cr, kLaserPoints);
            circle(cr, centre_px, 1.9);
            cairo_fill(cr);
          }};
}

LegendItem robot_item() {
  return {"robot", [](cairo_t* cr, const Eigen::Vector2d& centre_px) {
            draw_robot_marker(cr, centre_px, 0.8);
          }};
}

}  // namespace

void draw_local_map_panel(cairo_t* cr, const ScanView& view, const PlanFrame& frame) {
  draw_plan_axes(cr, frame);
  cairo_save(cr);
  clip_to(cr, frame.rect_px);
  draw_points(cr, view.map, frame, 2.0);
  draw_branches(cr, view.map, frame, 2.5);
  draw_robot_marker(cr, frame.to_px({0.0, 0.0}), 1.0);
  draw_nodes(cr, view.map, frame);
  draw_numbers(cr, view.map, frame);
  cairo_restore(cr);
  draw_border(cr, frame.rect_px);
}

void draw_local_map_thumbnail(cairo_t* cr, const ScanView& view, const PlanFrame& frame) {
  cairo_save(cr);
  clip_to(cr, frame.rect_px);
  draw_points(cr, view.map, frame, 1.5);
  draw_branches(cr, view.map, frame, 1.75);
  draw_robot_marker(cr, frame.to_px({0.0, 0.0}), 0.7);
  draw_nodes(cr, view.map, frame);
  cairo_restore(cr);
}

void draw_clearance_panel(cairo_t* cr, const ScanView& view, const Rect& rect) {
  const ClearancePlot plot(view, rect);
  for_each_tick(0.0, plot.top_m, tick_step(plot.top_m, 8.0), [&](double clearance_m) {
    draw_tick_up(cr, rect, plot.y_px(clearance_m), clearance_m);
  });
  draw_axis_names(cr, rect, "", "clearance (m)");
  set_colour(cr, kDoor);
  cairo_set_line_width(cr, 1.0);
  set_dashes(cr, true);
  move_to(cr, {rect.left, plot.y_px(view.local_map.door_half_width_m)});
  line_to(cr, {rect.right(), plot.y_px(view.local_map.door_half_width_m)});
  cairo_stroke(cr);
  set_dashes(cr, false);
  draw_clearance_lines(cr, view.map, plot);
  draw_clearance_nodes(cr, view.map, plot);
  draw_border(cr, rect);
  const double bar_m = round_length_m(std::min(1.0, 60.0 / plot.scale_px_per_m));
  draw_scale_bar(cr, bar_m, plot.scale_px_per_m, {rect.right(), rect.bottom() + 26.0});
}

std::vector<LegendItem> thumbnail_legend() {
  std::vector<LegendItem> items{robot_item(),
                                line_item("branch of the main graph", kBranch, 2.0, false),
                                line_item("branch off it", paled(kBranch, kPale), 2.0, false),
                                line_item("virtual branch", kVirtualBranch, 2.0, true)};
  for (const NodeKind kind : {NodeKind::kReal, NodeKind::kDoor, NodeKind::kNarrowing,
                              NodeKind::kHallCorridor, NodeKind::kFictitious, NodeKind::kVirtual}) {
    items.push_back(node_item(kind));
  }
  return items;
}

std::vector<LegendItem> scan_legend(const ScanView& view) {
  std::vector<LegendItem> items{group_item(),
                                dot_item(),
                                line_item("range limit", kRangeLimit, 1.5, true),
                                line_item("branch of the diagram", kDiagramBranch, 2.0, false),
                                circle_item(),
                                robot_item()};
  const auto& branches = view.map.branches;
  const auto has = [&](bool is_virtual, bool main) {
    return std::ranges::any_of(branches, [&](const LocalBranch& b) {
      return b.is_virtual == is_virtual && (is_virtual || b.in_main_graph == main);
    });
  };
  if (has(false, true)) items.push_back(line_item("branch of the main graph", kBranch, 2.5, false));
  if (has(false, false)) {
    items.push_back(line_item("branch off it", paled(kBranch, kPale), 2.5, false));
  }
  if (has(true, true)) items.push_back(line_item("virtual branch", kVirtualBranch, 2.5, true));
  for (LegendItem& item : node_items(view.map.nodes)) items.push_back(std::move(item));
  items.push_back(line_item("largest clearance of a door", kDoor, 1.0, true));
  return items;
}

}  // namespace topogeo::render
