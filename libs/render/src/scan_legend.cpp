// Legends of the pictures of scans.
#include <algorithm>

#include "branch_style.hpp"
#include "canvas.hpp"
#include "scan_panels.hpp"

namespace topogeo::render {
namespace {

using topomap::LocalBranch;
using topomap::NodeKind;

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
  return {"node of the diagram and its clearance",
          [](cairo_t* cr, const Eigen::Vector2d& centre_px) {
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

std::vector<LegendItem> thumbnail_legend() {
  std::vector<LegendItem> items{
      robot_item(), line_item("branch of the main graph", kBranch, 2.0, false),
      line_item("branch off it", paled(kBranch, kPale), 2.0, false),
      line_item("thin: what is unseen can still move it", kBranch, 0.8, false),
      line_item("virtual branch", kVirtualBranch, 2.0, true)};
  for (const NodeKind kind : {NodeKind::kReal, NodeKind::kDoor, NodeKind::kNarrowing,
                              NodeKind::kHallCorridor, NodeKind::kFictitious, NodeKind::kVirtual}) {
    items.push_back(node_item(kind));
  }
  return items;
}

std::vector<LegendItem> scan_legend(const ScanView& view) {
  std::vector<LegendItem> items{group_item(), dot_item(),
                                line_item("range limit", kRangeLimit, 1.5, true), robot_item()};
  if (!view.diagram.branches.empty()) {
    items.push_back(line_item("branch of the diagram", kDiagramBranch, 2.0, false));
  }
  if (!view.diagram.nodes.empty()) items.push_back(circle_item());
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
  const auto is_unsure = [](const LocalBranch& b) { return !b.confirmed; };
  if (std::ranges::any_of(branches, is_unsure)) {
    items.push_back(line_item("what is unseen can still move it", kBranch, 1.1, false));
  }
  if (has(true, true)) items.push_back(line_item("virtual branch", kVirtualBranch, 2.5, true));
  for (LegendItem& item : node_items(view.map.nodes)) items.push_back(std::move(item));
  items.push_back(line_item("largest clearance of a door", kDoor, 1.0, true));
  return items;
}

}  // namespace topogeo::render
