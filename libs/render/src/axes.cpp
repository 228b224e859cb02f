#include "axes.hpp"

#include <numbers>

#include "topogeo/support/format.hpp"

namespace topogeo::render {
namespace {

/// Without rounding noise or a negative zero.
std::string number(double value) {
  return fmt::format("{:g}", std::round(value * 1000.0) / 1000.0 + 0.0);
}

}  // namespace

double tick_step(double span, double most) {
  for (double power = 1e-3;; power *= 10.0) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (span <= most * factor * power) return factor * power;
    }
  }
}

void draw_tick_across(cairo_t* cr, const Rect& rect, double x_px, double value) {
  set_colour(cr, kGridLine);
  cairo_set_line_width(cr, 1.0);
  move_to(cr, {x_px, rect.top});
  line_to(cr, {x_px, rect.bottom()});
  cairo_stroke(cr);
  set_colour(cr, kInk);
  draw_text_centred(cr, number(value), x_px, rect.bottom() + 14.0, kAxisText_px);
}

void draw_tick_up(cairo_t* cr, const Rect& rect, double y_px, double value) {
  set_colour(cr, kGridLine);
  cairo_set_line_width(cr, 1.0);
  move_to(cr, {rect.left, y_px});
  line_to(cr, {rect.right(), y_px});
  cairo_stroke(cr);
  set_colour(cr, kInk);
  const std::string text = number(value);
  draw_text(cr, text, rect.left - 6.0 - text_width_px(cr, text, kAxisText_px), y_px + 4.0,
            kAxisText_px);
}

void draw_axis_names(cairo_t* cr, const Rect& rect, const std::string& across,
                     const std::string& up) {
  set_colour(cr, kInk);
  draw_text_centred(cr, across, rect.left + 0.5 * rect.width, rect.bottom() + 29.0, kAxisText_px);
  cairo_save(cr);
  cairo_translate(cr, rect.left - 34.0, rect.top + 0.5 * rect.height);
  cairo_rotate(cr, -0.5 * std::numbers::pi);
  draw_text_centred(cr, up, 0.0, 0.0, kAxisText_px);
  cairo_restore(cr);
}

void draw_border(cairo_t* cr, const Rect& rect) {
  set_colour(cr, kInk);
  cairo_set_line_width(cr, 1.0);
  cairo_rectangle(cr, rect.left, rect.top, rect.width, rect.height);
  cairo_stroke(cr);
}

}  // namespace topogeo::render
