// Parts of legends: samples with their texts, and scale bars.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <cairo.h>

#include "topogeo/topomap/local_map.hpp"

#include "canvas.hpp"

namespace topogeo::render {

struct LegendItem {
  std::string text;
  std::function<void(cairo_t*, const Eigen::Vector2d& centre_px)> draw_sample;
};

LegendItem line_item(const char* text, const Colour& colour, double width_px, bool dashed);
LegendItem node_item(topomap::NodeKind kind);

/// The kinds that occur among `nodes` (of any type with a `kind`), in a fixed order.
template <typename Node>
std::vector<LegendItem> node_items(const std::vector<Node>& nodes) {
  using topomap::NodeKind;
  std::vector<LegendItem> items;
  for (const NodeKind kind : {NodeKind::kReal, NodeKind::kDoor, NodeKind::kNarrowing,
                              NodeKind::kHallCorridor, NodeKind::kFictitious, NodeKind::kVirtual}) {
    for (const Node& node : nodes) {
      if (node.kind != kind) continue;
      items.push_back(node_item(kind));
      break;
    }
  }
  return items;
}

/// Rows of samples and texts from `start_px` (left, base line of the first row) up to `right_px`.
/// Returns the base line of the last row.
double draw_legend_items(cairo_t* cr, const std::vector<LegendItem>& items,
                         const Eigen::Vector2d& start_px, double right_px);

/// A bar that ends at `right_px` (right end, y of the bar) with its length above it.
void draw_scale_bar(cairo_t* cr, double length_m, double scale_px_per_m,
                    const Eigen::Vector2d& right_px);

/// Length of 1, 2 or 5 times a power of ten, at most `longest_m`.
double round_length_m(double longest_m);

}  // namespace topogeo::render
