#include "legend.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "canvas.hpp"
#include "legend_items.hpp"

namespace topogeo::render {
namespace {

// Sizes and colours on the page, chosen by eye.
constexpr double kLegendMargin_px = 24.0;
constexpr double kScaleBarSpace_px = 190.0;

LegendItem laser_item() {
  return {"laser points", [](cairo_t* cr, const Eigen::Vector2d& centre_px) {
            set_colour(cr, kLaserPoints);
            for (int i = -2; i <= 2; ++i) {
              cairo_rectangle(cr, centre_px.x() + 5.0 * i - 1.0, centre_px.y() - 1.0 + i % 2, 2, 2);
            }
            cairo_fill(cr);
          }};
}

std::vector<LegendItem> legend_items(const MapPicture& picture) {
  std::vector<LegendItem> items;
  if (!picture.stops.empty()) items.push_back(laser_item());
  if (!picture.corrected.empty()) {
    items.push_back(line_item("corrected trajectory", kCorrected, 2.0, false));
    items.push_back({"start", draw_start_marker});
  }
  if (!picture.unmatched_m.empty()) {
    items.push_back(line_item("by odometry alone", kCorrected, 2.0, true));
  }
  if (!picture.odometry.empty()) items.push_back(line_item("odometry", kOdometry, 1.5, false));
  if (!picture.loop_closures.empty()) {
    items.push_back(line_item("loop closure", kLoopClosure, 1.0, false));
  }
  if (picture.global_map != nullptr) {
    const auto& branches = picture.global_map->branches;
    const auto is_virtual = [](const topomap::MapBranch& branch) { return branch.is_virtual; };
    if (!std::ranges::all_of(branches, is_virtual)) {
      items.push_back(line_item("branch", kBranch, 2.0, false));
    }
    if (std::ranges::any_of(branches, is_virtual)) {
      items.push_back(line_item("virtual branch", kVirtualBranch, 2.0, true));
    }
    for (LegendItem& item : node_items(picture.global_map->nodes)) {
      items.push_back(std::move(item));
    }
  }
  return items;
}

}  // namespace

void draw_legend(cairo_t* cr, const MapPicture& picture, const Layout& layout) {
  const double top_px = layout.height_px - kLegendHeight_px;
  const double right_px = layout.width_px - kLegendMargin_px - kScaleBarSpace_px;
  draw_legend_items(cr, legend_items(picture), {kLegendMargin_px, top_px + 18.0}, right_px);

  const double longest_m = (kScaleBarSpace_px - 40.0) / layout.scale_px_per_m;
  const double length_m = round_length_m(std::min(longest_m, layout.max_m.x() - layout.min_m.x()));
  draw_scale_bar(cr, length_m, layout.scale_px_per_m,
                 {layout.width_px - kLegendMargin_px, top_px + 34.0});
}

}  // namespace topogeo::render
