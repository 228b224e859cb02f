#include "legend.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "canvas.hpp"

namespace topogeo::render {
namespace {

constexpr double kTextSize_px = 13.0;
constexpr double kSampleWidth_px = 26.0;
constexpr double kRowHeight_px = 21.0;
constexpr double kMargin_px = 24.0;
constexpr double kScaleBarSpace_px = 190.0;

struct Item {
  std::string text;
  std::function<void(cairo_t*, const Eigen::Vector2d& centre_px)> draw_sample;
};

Item line_item(const char* text, const Colour& colour, double width_px, bool dashed) {
  return {text, [=](cairo_t* cr, const Eigen::Vector2d& centre_px) {
            set_colour(cr, colour);
            cairo_set_line_width(cr, width_px);
            set_dashes(cr, dashed);
            cairo_move_to(cr, centre_px.x() - 0.5 * kSampleWidth_px, centre_px.y());
            cairo_line_to(cr, centre_px.x() + 0.5 * kSampleWidth_px, centre_px.y());
            cairo_stroke(cr);
            set_dashes(cr, false);
          }};
}

Item laser_item() {
  return {"laser points", [](cairo_t* cr, const Eigen::Vector2d& centre_px) {
            set_colour(cr, kLaserPoints);
            for (int i = -2; i <= 2; ++i) {
              cairo_rectangle(cr, centre_px.x() + 5.0 * i - 1.0, centre_px.y() - 1.0 + i % 2, 2, 2);
            }
            cairo_fill(cr);
          }};
}

std::vector<Item> node_items(const topomap::GlobalMap& map) {
  static constexpr std::array<std::pair<topomap::NodeKind, const char*>, 6> kKinds{
      {{topomap::NodeKind::kReal, "node"},
       {topomap::NodeKind::kDoor, "door"},
       {topomap::NodeKind::kNarrowing, "narrowing"},
       {topomap::NodeKind::kHallCorridor, "hall/corridor"},
       {topomap::NodeKind::kFictitious, "end of view"},
       {topomap::NodeKind::kVirtual, "virtual node"}}};
  std::vector<Item> items;
  for (const auto& [kind, text] : kKinds) {
    const auto is_kind = [k = kind](const topomap::MapNode& node) { return node.kind == k; };
    if (std::ranges::none_of(map.nodes, is_kind)) continue;
    items.push_back({text, [k = kind](cairo_t* cr, const Eigen::Vector2d& centre_px) {
                       draw_node_marker(cr, k, centre_px);
                     }});
  }
  return items;
}

std::vector<Item> legend_items(const MapPicture& picture) {
  std::vector<Item> items;
  if (!picture.stops.empty()) items.push_back(laser_item());
  if (!picture.corrected.empty()) {
    items.push_back(line_item("corrected trajectory", kCorrected, 2.0, false));
    items.push_back({"start", draw_start_marker});
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
    for (Item& item : node_items(*picture.global_map)) items.push_back(std::move(item));
  }
  return items;
}

void draw_scale_bar(cairo_t* cr, const Layout& layout, double top_px) {
  const double longest_m = (kScaleBarSpace_px - 40.0) / layout.scale_px_per_m;
  const double length_m = round_length_m(std::min(longest_m, layout.max_m.x() - layout.min_m.x()));
  const double length_px = length_m * layout.scale_px_per_m;
  const double left_px = layout.width_px - kMargin_px - length_px;
  const double y_px = top_px + 34.0;
  set_colour(cr, kInk);
  cairo_set_line_width(cr, 2.0);
  cairo_move_to(cr, left_px, y_px - 6.0);
  cairo_line_to(cr, left_px, y_px);
  cairo_line_to(cr, left_px + length_px, y_px);
  cairo_line_to(cr, left_px + length_px, y_px - 6.0);
  cairo_stroke(cr);
  const std::string text = fmt::format("{:g} m", length_m);
  const double text_px = text_width_px(cr, text, kTextSize_px);
  draw_text(cr, text, left_px + 0.5 * (length_px - text_px), y_px - 10.0, kTextSize_px);
}

}  // namespace

double round_length_m(double longest_m) {
  double power_m = 1.0;
  while (power_m > longest_m && power_m > 1e-3) power_m /= 10.0;
  while (power_m * 10.0 <= longest_m) power_m *= 10.0;
  for (const double factor : {5.0, 2.0}) {
    if (factor * power_m <= longest_m) return factor * power_m;
  }
  return power_m;
}

void draw_legend(cairo_t* cr, const MapPicture& picture, const Layout& layout) {
  const double top_px = layout.height_px - kLegendHeight_px;
  const double right_px = layout.width_px - kMargin_px - kScaleBarSpace_px;
  double x_px = kMargin_px;
  double y_px = top_px + 18.0;
  for (const Item& item : legend_items(picture)) {
    const double width_px = kSampleWidth_px + 6.0 + text_width_px(cr, item.text, kTextSize_px);
    if (x_px > kMargin_px && x_px + width_px > right_px) {
      x_px = kMargin_px;
      y_px += kRowHeight_px;
    }
    item.draw_sample(cr, {x_px + 0.5 * kSampleWidth_px, y_px - 4.5});
    set_colour(cr, kInk);
    draw_text(cr, item.text, x_px + kSampleWidth_px + 6.0, y_px, kTextSize_px);
    x_px += width_px + 18.0;
  }
  draw_scale_bar(cr, layout, top_px);
}

}  // namespace topogeo::render
