// Axes of all plots.
#pragma once

#include <cmath>
#include <string>

#include <cairo.h>

#include "canvas.hpp"
#include "rect.hpp"

namespace topogeo::render {

/// Space for the numbers and names of axes, and the size of their texts.
inline constexpr double kAxisLeft_px = 46.0;
inline constexpr double kAxisBelow_px = 36.0;
inline constexpr double kAxisText_px = 11.0;
inline constexpr Colour kGridLine{0.90, 0.90, 0.90};

/// The least step of 1, 2 or 5 times a power of ten that gives at most `most` steps over `span`.
double tick_step(double span, double most);

/// Calls `draw` for each multiple of `step` in [low, high].
template <typename Draw>
void for_each_tick(double low, double high, double step, const Draw& draw) {
  const int last = static_cast<int>(std::floor(high / step + 1e-9));
  for (int i = static_cast<int>(std::ceil(low / step - 1e-9)); i <= last; ++i) draw(i * step);
}

/// A grid line with its number, vertical at x_px or horizontal at y_px.
void draw_tick_across(cairo_t* cr, const Rect& rect, double x_px, double value);
void draw_tick_up(cairo_t* cr, const Rect& rect, double y_px, double value);

/// Names of the axes, beyond the numbers at their ticks.
void draw_axis_names(cairo_t* cr, const Rect& rect, const std::string& across,
                     const std::string& up);
void draw_border(cairo_t* cr, const Rect& rect);

}  // namespace topogeo::render
