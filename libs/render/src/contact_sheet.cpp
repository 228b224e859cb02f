#include "topogeo/render/contact_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "topogeo/support/format.hpp"

#include "axes.hpp"
#include "canvas.hpp"
#include "page.hpp"
#include "scan_panels.hpp"

namespace topogeo::render {
namespace {

// Sizes and colours on the page, chosen by eye.
constexpr double kSheetMargin_px = 20.0;
constexpr double kSheetHeader_px = 46.0;
constexpr double kLegend_px = 52.0;
constexpr double kGap_px = 8.0;
constexpr double kCaption_px = 18.0;
constexpr double kWanted_px = 252.0;     // width of a thumbnail
constexpr double kShape = 0.8;           // height to width
constexpr double kSheetScale_px = 40.0;  // of one metre

struct Sheet {
  std::size_t columns = 1;
  double cell_px = 0.0;    ///< width of a thumbnail
  double height_px = 0.0;  ///< of a thumbnail without its caption

  Sheet(std::size_t count, double width_px) {
    const double inner_px = width_px - 2 * kSheetMargin_px + kGap_px;
    columns = std::clamp<std::size_t>(static_cast<std::size_t>(inner_px / (kWanted_px + kGap_px)),
                                      1, std::max<std::size_t>(count, 1));
    cell_px = std::min(inner_px / static_cast<double>(columns) - kGap_px, 1.5 * kWanted_px);
    height_px = std::round(kShape * cell_px);
  }
  [[nodiscard]] double row_px() const { return kCaption_px + height_px + kGap_px; }
  [[nodiscard]] Rect thumbnail(std::size_t i) const {
    const std::size_t row = i / columns;
    const std::size_t column = i % columns;
    return {kSheetMargin_px + static_cast<double>(column) * (cell_px + kGap_px),
            kSheetHeader_px + kCaption_px + static_cast<double>(row) * row_px(), cell_px,
            height_px};
  }
};

void draw_thumbnail(cairo_t* cr, const ScanView& view, const Rect& rect) {
  constexpr double kText_px = 12.0;
  const PlanFrame frame = fit(extent_of(view), rect, kSheetScale_px);
  draw_local_map_thumbnail(cr, view, frame);
  set_colour(cr, kLaserPoints);
  cairo_set_line_width(cr, 0.75);
  cairo_rectangle(cr, rect.left, rect.top, rect.width, rect.height);
  cairo_stroke(cr);
  set_colour(cr, view.diagram.is_virtual ? kCorrected : kInk);
  const auto real =
      std::ranges::count(view.map.nodes, topomap::NodeKind::kReal, &topomap::LocalNode::kind);
  draw_text(cr,
            fmt::format("scan {}{}   {} groups, {} real nodes", view.scan.sequence,
                        view.diagram.is_virtual ? " virtual" : "",
                        view.diagram.groups.groups.size(), real),
            rect.left + 2.0, rect.top - 5.0, kText_px);
  // A scale bar of one metre in the corner.
  set_colour(cr, kInk);
  cairo_set_line_width(cr, 2.0);
  move_to(cr, {rect.right() - 5.0 - frame.scale_px_per_m, rect.bottom() - 5.0});
  line_to(cr, {rect.right() - 5.0, rect.bottom() - 5.0});
  cairo_stroke(cr);
}

}  // namespace

std::string contact_sheet(const std::vector<ScanView>& views, const std::string& title,
                          PictureFormat format, const PictureOptions& options) {
  check(options);
  if (views.empty() || views.size() > kMostThumbnails) {
    throw std::invalid_argument(
        fmt::format("contact sheet of {} scans: expected 1 to {}", views.size(), kMostThumbnails));
  }
  const double width_px = options.max_width_px;
  const Sheet sheet(views.size(), width_px);
  const std::size_t rows = (views.size() + sheet.columns - 1) / sheet.columns;
  const double height_px =
      kSheetHeader_px + static_cast<double>(rows) * sheet.row_px() + kLegend_px;
  return draw_page(
      format, options.max_width_px, static_cast<std::uint32_t>(std::ceil(height_px)),
      [&](cairo_t* cr) {
        start_page(cr);
        set_colour(cr, kInk);
        draw_text(cr, title, kSheetMargin_px, 28.0, 18.0);
        for (std::size_t i = 0; i < views.size(); ++i) {
          draw_thumbnail(cr, views[i], sheet.thumbnail(i));
        }
        std::vector<LegendItem> items = thumbnail_legend();
        items.push_back(line_item("1 m (x forward is up, y left to the left)", kInk, 2.0, false));
        draw_legend_items(cr, items, {kSheetMargin_px, height_px - kLegend_px + 20.0},
                          width_px - kSheetMargin_px);
      });
}

}  // namespace topogeo::render
