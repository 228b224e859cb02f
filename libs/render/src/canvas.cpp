#include "canvas.hpp"

#include <cmath>
#include <numbers>

namespace topogeo::render {
namespace {

void polygon(cairo_t* cr, const Eigen::Vector2d& centre_px, double radius_px, int corners,
             double first_rad) {
  for (int i = 0; i < corners; ++i) {
    const double angle_rad = first_rad + 2.0 * std::numbers::pi * i / corners;
    cairo_line_to(cr, centre_px.x() + radius_px * std::cos(angle_rad),
                  centre_px.y() - radius_px * std::sin(angle_rad));
  }
  cairo_close_path(cr);
}

void set_plain_text(cairo_t* cr) {
  // No subpixel colours and no hinting, whatever the machine's settings.
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(cr, options);
  cairo_font_options_destroy(options);
}

}  // namespace

void start_page(cairo_t* cr) {
  set_colour(cr, kWhite);
  cairo_paint(cr);
  set_plain_text(cr);
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
  cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
}

double snapped(double value_px) {
  return std::round(value_px * 4.0) / 4.0;
}

void move_to(cairo_t* cr, const Eigen::Vector2d& point_px) {
  cairo_move_to(cr, snapped(point_px.x()), snapped(point_px.y()));
}
void line_to(cairo_t* cr, const Eigen::Vector2d& point_px) {
  cairo_line_to(cr, snapped(point_px.x()), snapped(point_px.y()));
}

void circle(cairo_t* cr, const Eigen::Vector2d& centre_px, double radius_px) {
  cairo_new_sub_path(cr);
  cairo_arc(cr, centre_px.x(), centre_px.y(), radius_px, 0.0, 2.0 * std::numbers::pi);
}

void fill_and_edge(cairo_t* cr, const Colour& fill, const Colour& edge, double edge_px) {
  set_colour(cr, fill);
  cairo_fill_preserve(cr);
  set_colour(cr, edge);
  cairo_set_line_width(cr, edge_px);
  cairo_stroke(cr);
}

void draw_text(cairo_t* cr, const std::string& text, double x_px, double y_px, double size_px) {
  cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cr, size_px);
  cairo_move_to(cr, x_px, y_px);
  cairo_show_text(cr, text.c_str());
  cairo_new_path(cr);
}

void draw_text_centred(cairo_t* cr, const std::string& text, double x_px, double y_px,
                       double size_px) {
  draw_text(cr, text, x_px - 0.5 * text_width_px(cr, text, size_px), y_px, size_px);
}

double text_width_px(cairo_t* cr, const std::string& text, double size_px) {
  cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cr, size_px);
  cairo_text_extents_t extents{};
  cairo_text_extents(cr, text.c_str(), &extents);
  return extents.x_advance;
}

void draw_node_marker(cairo_t* cr, topomap::NodeKind kind, const Eigen::Vector2d& centre_px,
                      double strength) {
  constexpr double kUp_rad = std::numbers::pi / 2;
  const auto finish = [&](const Colour& fill, const Colour& edge, double edge_px) {
    fill_and_edge(cr, paled(fill, strength), paled(edge, strength), edge_px);
  };
  switch (kind) {
    case topomap::NodeKind::kReal:
      circle(cr, centre_px, 4.0);
      finish(kBranch, kWhite, 1.0);
      break;
    case topomap::NodeKind::kFictitious:
      circle(cr, centre_px, 3.0);
      finish(kWhite, kBranch, 1.25);
      break;
    case topomap::NodeKind::kVirtual:
      polygon(cr, centre_px, 4.5, 4, 0.0);
      finish(kVirtualBranch, kInk, 0.75);
      break;
    case topomap::NodeKind::kDoor:
      polygon(cr, centre_px, 6.5, 4, kUp_rad / 2);
      finish(kDoor, kWhite, 1.0);
      break;
    case topomap::NodeKind::kNarrowing:
      polygon(cr, centre_px, 6.0, 3, kUp_rad);
      finish(kOdometry, kInk, 0.75);
      break;
    case topomap::NodeKind::kHallCorridor:
      polygon(cr, centre_px, 5.5, 6, 0.0);
      finish(kWhite, kInk, 1.5);
      break;
  }
}

void draw_start_marker(cairo_t* cr, const Eigen::Vector2d& centre_px) {
  circle(cr, centre_px, 8.0);
  fill_and_edge(cr, kWhite, kInk, 2.0);
  circle(cr, centre_px, 3.5);
  set_colour(cr, kInk);
  cairo_fill(cr);
}

void draw_robot_marker(cairo_t* cr, const Eigen::Vector2d& centre_px, double size) {
  cairo_move_to(cr, centre_px.x(), centre_px.y() - 9.0 * size);
  cairo_line_to(cr, centre_px.x() + 6.5 * size, centre_px.y() + 7.0 * size);
  cairo_line_to(cr, centre_px.x(), centre_px.y() + 3.5 * size);
  cairo_line_to(cr, centre_px.x() - 6.5 * size, centre_px.y() + 7.0 * size);
  cairo_close_path(cr);
  fill_and_edge(cr, kCorrected, kWhite, 1.0);
}

}  // namespace topogeo::render
