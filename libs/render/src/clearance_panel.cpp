// Panel of the clearance along the branches of a local map.
#include <algorithm>
#include <string>
#include <vector>

#include "topogeo/support/format.hpp"
#include "topogeo/topomap/arc_length.hpp"

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
using topomap::NodeKind;

/// Whether branch i + 1 continues the curve of branch i.
bool continues(const LocalMap& map, std::size_t i) {
  if (i + 1 >= map.branches.size()) return false;
  const LocalBranch& piece = map.branches[i];
  const LocalBranch& next = map.branches[i + 1];
  return piece.node_b == next.node_a && piece.node_b < map.nodes.size() &&
         map.nodes[piece.node_b].kind != NodeKind::kReal && piece.base_groups == next.base_groups;
}

/// Positions of the branches side by side and scales of the clearance plot.
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
      arc_m.push_back(topomap::arc_lengths_m(map.branches[i].points));
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
  for (std::size_t i = 0; i < map.branches.size(); ++i) {
    const LocalBranch& branch = map.branches[i];
    set_branch_stroke(cr, branch, 1.75);
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

}  // namespace

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

}  // namespace topogeo::render
