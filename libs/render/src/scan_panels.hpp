// The panels of the picture of one scan, each in a rectangle of the page.
#pragma once

#include <vector>

#include <cairo.h>

#include "topogeo/render/scan_view.hpp"

#include "legend_items.hpp"
#include "plan_frame.hpp"
#include "rect.hpp"

namespace topogeo::render {

/// Colour of a generator group; neighbours differ.
Colour group_colour(std::size_t group);

/// Range against beam angle in the laser frame, positive angles (left) on the left.
void draw_polar_panel(cairo_t* cr, const ScanView& view, const Rect& rect);

/// Scan points with the groups in colour and numbered, over the space proved free.
void draw_groups_panel(cairo_t* cr, const ScanView& view, const PlanFrame& frame);

/// Cells in the pale colour of their nearest group, branches and nodes of the diagram, and the
/// circle of clearance about each node.
void draw_diagram_panel(cairo_t* cr, const ScanView& view, const PlanFrame& frame);

/// Branches and nodes of the local map, numbered; pale if off the main graph.
void draw_local_map_panel(cairo_t* cr, const ScanView& view, const PlanFrame& frame);

/// The same small: thin strokes and no numbers.
void draw_local_map_thumbnail(cairo_t* cr, const ScanView& view, const PlanFrame& frame);

/// Clearance along all branches, side by side; the pieces of a branch with states follow each other
/// without a gap.
void draw_clearance_panel(cairo_t* cr, const ScanView& view, const Rect& rect);

/// Legend of the panels of this view.
std::vector<LegendItem> scan_legend(const ScanView& view);
/// Legend of the thumbnails of any view.
std::vector<LegendItem> thumbnail_legend();

}  // namespace topogeo::render
