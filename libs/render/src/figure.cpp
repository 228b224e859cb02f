#include "topogeo/render/figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "axes.hpp"
#include "canvas.hpp"
#include "page.hpp"

namespace topogeo::render {
namespace {

// Sizes on the page, chosen by eye.
constexpr double kFigureMargin_px = 18.0;
constexpr double kFigureTitle_px = 42.0;
constexpr double kPanelHeading_px = 24.0;
constexpr double kFigureNote_px = 18.0;
constexpr double kLeastAspect = 0.45;  // height of a panel relative to its width
constexpr double kMostAspect = 1.6;
constexpr double kFreeAspect = 0.7;

Colour colour_of(FigureColour colour) {
  constexpr std::array<Colour, 10> kColours{{kInk, kLaserPoints, kFreeSpace, kDiagramBranch,
                                             kDiagramNode, kCorrected, kOdometry, kVirtualBranch,
                                             kLoopClosure, kDoor}};
  return kColours[static_cast<std::size_t>(colour)];
}

/// All points of a panel.
template <typename Visit>
void for_each_point(const FigurePanel& panel, const Visit& visit) {
  for (const FigureLine& line : panel.lines) {
    for (const Eigen::Vector2d& point : line.points) visit(point);
  }
  for (const FigureDots& dots : panel.dots) {
    for (const Eigen::Vector2d& point : dots.points) visit(point);
  }
  for (const FigureText& text : panel.texts) visit(text.at);
}

FigureExtent extent_of_panel(const FigurePanel& panel) {
  if (panel.extent) return *panel.extent;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  FigureExtent extent{{kFar, kFar}, {-kFar, -kFar}};
  for_each_point(panel, [&](const Eigen::Vector2d& point) {
    extent.low = extent.low.cwiseMin(point);
    extent.high = extent.high.cwiseMax(point);
  });
  if (!(extent.low.x() <= extent.high.x())) return {};
  Eigen::Vector2d border = 0.05 * (extent.high - extent.low);
  if (panel.equal_scale) border = Eigen::Vector2d::Constant(std::max(border.maxCoeff(), 0.1));
  for (Eigen::Index k = 0; k < 2; ++k) {
    if (!(border[k] > 0.0)) border[k] = 0.5;
  }
  return {extent.low - border, extent.high + border};
}

void check_panel(const FigurePanel& panel) {
  bool finite = true;
  for_each_point(panel, [&](const Eigen::Vector2d& point) { finite &= point.allFinite(); });
  if (!finite) throw std::invalid_argument("figure: panel '" + panel.title + "' is not finite");
}

/// A panel on the page.
struct PlacedPanel {
  Rect rect;
  Eigen::Vector2d low = Eigen::Vector2d::Zero();
  Eigen::Vector2d scale_px = Eigen::Vector2d::Ones();

  [[nodiscard]] Eigen::Vector2d to_px(const Eigen::Vector2d& point) const {
    return {rect.left + (point.x() - low.x()) * scale_px.x(),
            rect.bottom() - (point.y() - low.y()) * scale_px.y()};
  }
};

PlacedPanel place_panel(const FigurePanel& panel, const Rect& rect) {
  const FigureExtent extent = extent_of_panel(panel);
  const Eigen::Vector2d size = extent.high - extent.low;
  PlacedPanel placed{rect, extent.low, {rect.width / size.x(), rect.height / size.y()}};
  if (panel.equal_scale) {
    placed.scale_px.setConstant(placed.scale_px.minCoeff());
    const Eigen::Vector2d shown =
        Eigen::Vector2d(rect.width, rect.height).cwiseQuotient(placed.scale_px);
    placed.low -= 0.5 * (shown - size);
  }
  return placed;
}

double aspect_of(const FigurePanel& panel) {
  if (!panel.equal_scale) return kFreeAspect;
  const FigureExtent extent = extent_of_panel(panel);
  const Eigen::Vector2d size = extent.high - extent.low;
  return std::clamp(size.y() / size.x(), kLeastAspect, kMostAspect);
}

void draw_figure_axes(cairo_t* cr, const FigurePanel& panel, const PlacedPanel& placed) {
  const Rect& rect = placed.rect;
  const double span_x = rect.width / placed.scale_px.x();
  const double span_y = rect.height / placed.scale_px.y();
  double step_x = tick_step(span_x, rect.width / 55.0);
  double step_y = tick_step(span_y, rect.height / 35.0);
  if (panel.equal_scale) step_x = step_y = std::max(step_x, step_y);
  for_each_tick(placed.low.x(), placed.low.x() + span_x, step_x, [&](double x) {
    draw_tick_across(cr, rect, placed.to_px({x, 0.0}).x(), x);
  });
  for_each_tick(placed.low.y(), placed.low.y() + span_y, step_y, [&](double y) {
    draw_tick_up(cr, rect, placed.to_px({0.0, y}).y(), y);
  });
  draw_axis_names(cr, rect, panel.across, panel.up);
}

void draw_figure_line(cairo_t* cr, const FigureLine& line, const PlacedPanel& placed) {
  if (line.points.empty()) return;
  set_colour(cr, colour_of(line.colour));
  for (const Eigen::Vector2d& point : line.points) line_to(cr, placed.to_px(point));
  if (line.closed || line.filled) cairo_close_path(cr);
  if (line.filled) {
    cairo_fill(cr);
    return;
  }
  set_dashes(cr, line.dashed);
  cairo_set_line_width(cr, line.width_px);
  cairo_stroke(cr);
  set_dashes(cr, false);
}

void draw_figure_dots(cairo_t* cr, const FigureDots& dots, const PlacedPanel& placed) {
  const Colour colour = colour_of(dots.colour);
  for (const Eigen::Vector2d& point : dots.points) {
    const Eigen::Vector2d px = placed.to_px(point);
    circle(cr, {snapped(px.x()), snapped(px.y())}, dots.radius_px);
    if (dots.ring) {
      fill_and_edge(cr, kWhite, colour, 1.25);
    } else if (dots.radius_px >= 3.0) {
      fill_and_edge(cr, colour, kWhite, 0.75);
    } else {
      set_colour(cr, colour);
      cairo_fill(cr);
    }
  }
}

void draw_figure_panel(cairo_t* cr, const FigurePanel& panel, const Rect& rect) {
  const PlacedPanel placed = place_panel(panel, rect);
  draw_figure_axes(cr, panel, placed);
  set_colour(cr, kInk);
  draw_text(cr, panel.title, rect.left, rect.top - 8.0, 13.0);
  cairo_save(cr);
  cairo_rectangle(cr, rect.left, rect.top, rect.width, rect.height);
  cairo_clip(cr);
  for (const bool filled : {true, false}) {
    for (const FigureLine& line : panel.lines) {
      if (line.filled == filled) draw_figure_line(cr, line, placed);
    }
  }
  for (const FigureDots& dots : panel.dots) draw_figure_dots(cr, dots, placed);
  for (const FigureText& text : panel.texts) {
    const Eigen::Vector2d px = placed.to_px(text.at);
    set_colour(cr, colour_of(text.colour));
    draw_text_centred(cr, text.text, px.x(), px.y() + 4.0, 12.0);
  }
  cairo_restore(cr);
  draw_border(cr, rect);
}

/// Rectangles of the panels, row by row, equally high within a row; then the start of the notes.
struct FigurePage {
  std::vector<Rect> rects;
  double bottom_px = 0.0;
};

FigurePage arrange_figure(const Figure& figure, double width_px) {
  const std::size_t count = figure.panels.size();
  const std::size_t columns = figure.columns > 0 ? figure.columns : std::min<std::size_t>(count, 3);
  const double cell_px =
      (width_px - kFigureMargin_px) / static_cast<double>(columns) - kFigureMargin_px;
  const double panel_px = cell_px - kAxisLeft_px;
  FigurePage page;
  page.bottom_px = kFigureTitle_px;
  for (std::size_t first = 0; first < count; first += columns) {
    const std::size_t end = std::min(count, first + columns);
    double height_px = 0.0;
    for (std::size_t i = first; i < end; ++i) {
      height_px = std::max(height_px, std::round(panel_px * aspect_of(figure.panels[i])));
    }
    for (std::size_t i = first; i < end; ++i) {
      const double left_px =
          kFigureMargin_px + static_cast<double>(i - first) * (cell_px + kFigureMargin_px);
      page.rects.push_back(
          {left_px + kAxisLeft_px, page.bottom_px + kPanelHeading_px, panel_px, height_px});
    }
    page.bottom_px += kPanelHeading_px + height_px + kAxisBelow_px + 0.5 * kFigureMargin_px;
  }
  return page;
}

}  // namespace

std::string figure_picture(const Figure& figure, PictureFormat format,
                           const PictureOptions& options) {
  check(options);
  if (figure.panels.empty()) throw std::invalid_argument("figure: no panels");
  for (const FigurePanel& panel : figure.panels) check_panel(panel);
  const FigurePage page = arrange_figure(figure, options.max_width_px);
  const double height_px =
      page.bottom_px + kFigureMargin_px + kFigureNote_px * static_cast<double>(figure.notes.size());
  return draw_page(format, options.max_width_px, static_cast<std::uint32_t>(std::ceil(height_px)),
                   [&](cairo_t* cr) {
                     start_page(cr);
                     set_colour(cr, kInk);
                     draw_text(cr, figure.title, kFigureMargin_px, 28.0, 17.0);
                     for (std::size_t i = 0; i < figure.panels.size(); ++i) {
                       draw_figure_panel(cr, figure.panels[i], page.rects[i]);
                     }
                     set_colour(cr, kInk);
                     for (std::size_t i = 0; i < figure.notes.size(); ++i) {
                       draw_text(cr, figure.notes[i], kFigureMargin_px,
                                 page.bottom_px + kFigureNote_px * static_cast<double>(i + 1) - 4.0,
                                 13.0);
                     }
                   });
}

}  // namespace topogeo::render
