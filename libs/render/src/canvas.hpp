// Colours, strokes, text and node markers of all pictures and their legends.
#pragma once

#include <string>

#include <Eigen/Core>
#include <cairo.h>

#include "topogeo/topomap/local_map.hpp"

namespace topogeo::render {

struct Colour {
  double red;
  double green;
  double blue;
};

// Hues that colour-blind readers can distinguish (after Okabe and Ito); shapes differ as well.
inline constexpr Colour kInk{0.13, 0.13, 0.13};
inline constexpr Colour kLaserPoints{0.62, 0.62, 0.62};
inline constexpr Colour kBranch{0.00, 0.45, 0.70};
inline constexpr Colour kVirtualBranch{0.34, 0.71, 0.91};
inline constexpr Colour kCorrected{0.80, 0.10, 0.10};
inline constexpr Colour kOdometry{0.95, 0.60, 0.05};
inline constexpr Colour kLoopClosure{0.55, 0.20, 0.65};
inline constexpr Colour kDoor{0.00, 0.60, 0.40};
inline constexpr Colour kNoGoZone{0.78, 0.16, 0.16};
inline constexpr Colour kSlowZone{0.90, 0.55, 0.10};
inline constexpr Colour kOneWayZone{0.16, 0.40, 0.70};
inline constexpr Colour kPreferredLane{0.06, 0.46, 0.43};
inline constexpr Colour kDrawnRoom{0.40, 0.35, 0.70};
inline constexpr Colour kWhite{1.0, 1.0, 1.0};
// Colours of one scan; branches and nodes of the diagram as in the figures of the Thesis, chapter
// 4.
inline constexpr Colour kDiagramBranch{0.00, 0.58, 0.15};
inline constexpr Colour kDiagramNode{0.10, 0.15, 0.90};
inline constexpr Colour kFreeSpace{0.93, 0.95, 0.98};
inline constexpr Colour kRangeLimit{0.45, 0.45, 0.45};

inline void set_colour(cairo_t* cr, const Colour& c) {
  cairo_set_source_rgb(cr, c.red, c.green, c.blue);
}

/// `c` on white paper at `strength` in [0, 1]: 1 is the colour itself, 0 white.
inline Colour paled(const Colour& c, double strength) {
  const auto mixed = [&](double part) { return 1.0 - strength * (1.0 - part); };
  return {mixed(c.red), mixed(c.green), mixed(c.blue)};
}

/// White paper, round strokes, the same text rendering on every machine.
void start_page(cairo_t* cr);

/// A quarter of a pixel: finer steps are invisible but make the numbers in an SVG longer.
double snapped(double value_px);
void move_to(cairo_t* cr, const Eigen::Vector2d& point_px);
void line_to(cairo_t* cr, const Eigen::Vector2d& point_px);

/// Adds a circle to the path.
void circle(cairo_t* cr, const Eigen::Vector2d& centre_px, double radius_px);
/// Fills and outlines the path and ends it.
void fill_and_edge(cairo_t* cr, const Colour& fill, const Colour& edge, double edge_px);

/// A text whose baseline starts at (x_px, y_px).
void draw_text(cairo_t* cr, const std::string& text, double x_px, double y_px, double size_px);
/// The same, centred at x_px.
void draw_text_centred(cairo_t* cr, const std::string& text, double x_px, double y_px,
                       double size_px);
double text_width_px(cairo_t* cr, const std::string& text, double size_px);

inline constexpr double kDashes_px = 5.0;
inline void set_dashes(cairo_t* cr, bool dashed) {
  cairo_set_dash(cr, &kDashes_px, dashed ? 1 : 0, 0.0);
}

/// The marker of a kind of node, centred; `strength` as for `paled`.
void draw_node_marker(cairo_t* cr, topomap::NodeKind kind, const Eigen::Vector2d& centre_px,
                      double strength = 1.0);

/// Start of the robot: a disc in a ring.
void draw_start_marker(cairo_t* cr, const Eigen::Vector2d& centre_px);

/// The robot, facing up: an arrow head about its position, 16 px long at `size` 1.
void draw_robot_marker(cairo_t* cr, const Eigen::Vector2d& centre_px, double size);

}  // namespace topogeo::render
