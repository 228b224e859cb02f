#include "topogeo/render/scan_picture.hpp"

#include <algorithm>
#include <cmath>

#include "axes.hpp"
#include "canvas.hpp"
#include "page.hpp"
#include "scan_caption.hpp"
#include "scan_panels.hpp"

namespace topogeo::render {
namespace {

// Sizes and colours on the page, chosen by eye.
constexpr double kScanMargin_px = 20.0;
constexpr double kScanHeader_px = 66.0;
constexpr double kPanelTitle_px = 24.0;
constexpr double kClearance_px = 190.0;
constexpr double kLegendSpace_px = 76.0;
constexpr double kScanScale_px = 160.0;  // of one metre

/// Arrangement of the panels: polar | groups, diagram | local map, clearance over the full width.
struct Panels {
  Rect polar;
  Rect groups;
  Rect diagram;
  Rect local_map;
  Rect clearance;
  double legend_top = 0.0;
  std::uint32_t height_px = 0;
};

Panels arrange(const Extent& extent, double width_px) {
  const double plot_px = 0.5 * (width_px - 3 * kScanMargin_px) - kAxisLeft_px;
  const Eigen::Vector2d size_m = extent.max_m - extent.min_m;
  const double height_px = std::round(plot_px * std::clamp(size_m.x() / size_m.y(), 0.5, 1.0));
  const double left_px = kScanMargin_px + kAxisLeft_px;
  const double second_px = left_px + plot_px + kScanMargin_px + kAxisLeft_px;
  const double top_px = kScanHeader_px + kPanelTitle_px;
  const double row_px = height_px + kAxisBelow_px + kPanelTitle_px + 4.0;
  Panels panels;
  panels.polar = {left_px, top_px, plot_px, height_px};
  panels.groups = {second_px, top_px, plot_px, height_px};
  panels.diagram = {left_px, top_px + row_px, plot_px, height_px};
  panels.local_map = {second_px, top_px + row_px, plot_px, height_px};
  panels.clearance = {left_px, top_px + 2 * row_px, width_px - kScanMargin_px - left_px,
                      kClearance_px};
  panels.legend_top = panels.clearance.bottom() + kAxisBelow_px;
  panels.height_px = static_cast<std::uint32_t>(std::ceil(panels.legend_top + kLegendSpace_px));
  return panels;
}

void draw_panel_title(cairo_t* cr, const Rect& rect, const char* text) {
  set_colour(cr, kInk);
  draw_text(cr, text, rect.left, rect.top - 8.0, 14.0);
}

void draw_scan(cairo_t* cr, const ScanView& view, const std::string& log_name, const Panels& panels,
               const Extent& extent) {
  start_page(cr);
  set_colour(cr, kInk);
  draw_text(cr, scan_title(view, log_name), kScanMargin_px, 28.0, 18.0);
  draw_text(cr, scan_counts(view), kScanMargin_px, 50.0, 13.0);

  draw_panel_title(cr, panels.polar, "Readings, in polar coordinates");
  draw_polar_panel(cr, view, panels.polar);
  draw_panel_title(cr, panels.groups, "Generator groups and space known to be free");
  draw_groups_panel(cr, view, fit(extent, panels.groups, kScanScale_px));
  draw_panel_title(cr, panels.diagram, "Local Voronoi diagram");
  draw_diagram_panel(cr, view, fit(extent, panels.diagram, kScanScale_px));
  draw_panel_title(cr, panels.local_map, "Local topo-geometric map");
  draw_local_map_panel(cr, view, fit(extent, panels.local_map, kScanScale_px));
  draw_panel_title(cr, panels.clearance, "Clearance along the branches, one behind the other");
  draw_clearance_panel(cr, view, panels.clearance);
  draw_legend_items(cr, scan_legend(view), {kScanMargin_px, panels.legend_top + 18.0},
                    panels.clearance.right());
}

}  // namespace

std::string scan_picture(const ScanView& view, const std::string& log_name, PictureFormat format,
                         const PictureOptions& options) {
  check(options);
  const Extent extent = extent_of(view);
  const Panels panels = arrange(extent, options.max_width_px);
  return draw_page(format, options.max_width_px, panels.height_px,
                   [&](cairo_t* cr) { draw_scan(cr, view, log_name, panels, extent); });
}

}  // namespace topogeo::render
