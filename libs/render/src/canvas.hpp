// Colours, text and node markers: what the map and its legend draw in the same way.
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

// Hues that colour-blind readers tell apart (after Okabe and Ito); shapes differ as well.
inline constexpr Colour kInk{0.13, 0.13, 0.13};
inline constexpr Colour kLaserPoints{0.62, 0.62, 0.62};
inline constexpr Colour kBranch{0.00, 0.45, 0.70};
inline constexpr Colour kVirtualBranch{0.34, 0.71, 0.91};
inline constexpr Colour kCorrected{0.80, 0.10, 0.10};
inline constexpr Colour kOdometry{0.95, 0.60, 0.05};
inline constexpr Colour kLoopClosure{0.55, 0.20, 0.65};
inline constexpr Colour kDoor{0.00, 0.60, 0.40};
inline constexpr Colour kWhite{1.0, 1.0, 1.0};

inline void set_colour(cairo_t* cr, const Colour& c) {
  cairo_set_source_rgb(cr, c.red, c.green, c.blue);
}

/// A text whose baseline starts at (x_px, y_px).
void draw_text(cairo_t* cr, const std::string& text, double x_px, double y_px, double size_px);
double text_width_px(cairo_t* cr, const std::string& text, double size_px);

inline constexpr double kDashes_px = 5.0;
inline void set_dashes(cairo_t* cr, bool dashed) {
  cairo_set_dash(cr, &kDashes_px, dashed ? 1 : 0, 0.0);
}

/// The marker of a kind of node, centred.
void draw_node_marker(cairo_t* cr, topomap::NodeKind kind, const Eigen::Vector2d& centre_px);

/// Where the robot started: a disc in a ring.
void draw_start_marker(cairo_t* cr, const Eigen::Vector2d& centre_px);

}  // namespace topogeo::render
