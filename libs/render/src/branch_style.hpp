// Colours and strokes of the branches and nodes of a local map in every panel.
#pragma once

#include <cairo.h>

#include "topogeo/topomap/local_map.hpp"

#include "canvas.hpp"

namespace topogeo::render {

inline constexpr double kPale = 0.35;  ///< strength of everything off the main graph

inline double strength(bool in_main_graph) {
  return in_main_graph ? 1.0 : kPale;
}

/// Colour, dashes and width of a branch: thin if unconfirmed.
inline void set_branch_stroke(cairo_t* cr, const topomap::LocalBranch& branch, double width_px) {
  constexpr double kThin = 0.45;
  set_colour(cr,
             paled(branch.is_virtual ? kVirtualBranch : kBranch, strength(branch.in_main_graph)));
  set_dashes(cr, branch.is_virtual);
  cairo_set_line_width(cr, branch.confirmed ? width_px : kThin * width_px);
}

}  // namespace topogeo::render
