#include "legend_items.hpp"

#include "topogeo/support/format.hpp"

namespace topogeo::render {
namespace {

// Sizes and colours on the page, chosen by eye.
constexpr double kTextSize_px = 13.0;
constexpr double kSampleWidth_px = 26.0;
constexpr double kRowHeight_px = 21.0;

const char* text_of(topomap::NodeKind kind) {
  switch (kind) {
    case topomap::NodeKind::kReal:
      return "junction";
    case topomap::NodeKind::kFictitious:
      return "fictitious node: where the view ends";
    case topomap::NodeKind::kVirtual:
      return "virtual node";
    case topomap::NodeKind::kDoor:
      return "door";
    case topomap::NodeKind::kNarrowing:
      return "narrowing";
    case topomap::NodeKind::kHallCorridor:
      return "hall-corridor passage";
  }
  return "unknown kind";
}

}  // namespace

LegendItem line_item(const char* text, const Colour& colour, double width_px, bool dashed) {
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

LegendItem node_item(topomap::NodeKind kind) {
  return {text_of(kind), [kind](cairo_t* cr, const Eigen::Vector2d& centre_px) {
            draw_node_marker(cr, kind, centre_px);
          }};
}

double draw_legend_items(cairo_t* cr, const std::vector<LegendItem>& items,
                         const Eigen::Vector2d& start_px, double right_px) {
  double x_px = start_px.x();
  double y_px = start_px.y();
  for (const LegendItem& item : items) {
    const double width_px = kSampleWidth_px + 6.0 + text_width_px(cr, item.text, kTextSize_px);
    if (x_px > start_px.x() && x_px + width_px > right_px) {
      x_px = start_px.x();
      y_px += kRowHeight_px;
    }
    item.draw_sample(cr, {x_px + 0.5 * kSampleWidth_px, y_px - 4.5});
    set_colour(cr, kInk);
    draw_text(cr, item.text, x_px + kSampleWidth_px + 6.0, y_px, kTextSize_px);
    x_px += width_px + 18.0;
  }
  return y_px;
}

void draw_scale_bar(cairo_t* cr, double length_m, double scale_px_per_m,
                    const Eigen::Vector2d& right_px) {
  const double length_px = length_m * scale_px_per_m;
  const double left_px = right_px.x() - length_px;
  const double y_px = right_px.y();
  set_colour(cr, kInk);
  cairo_set_line_width(cr, 2.0);
  cairo_move_to(cr, left_px, y_px - 6.0);
  cairo_line_to(cr, left_px, y_px);
  cairo_line_to(cr, left_px + length_px, y_px);
  cairo_line_to(cr, left_px + length_px, y_px - 6.0);
  cairo_stroke(cr);
  draw_text_centred(cr, fmt::format("{:g} m", length_m), left_px + 0.5 * length_px, y_px - 10.0,
                    kTextSize_px);
}

double round_length_m(double longest_m) {
  double power_m = 1.0;
  while (power_m > longest_m && power_m > 1e-3) power_m /= 10.0;
  while (power_m * 10.0 <= longest_m) power_m *= 10.0;
  for (const double factor : {5.0, 2.0}) {
    if (factor * power_m <= longest_m) return factor * power_m;
  }
  return power_m;
}

}  // namespace topogeo::render
