// A picture of one scan: polar plot, generator groups, local Voronoi diagram, local topo-geometric
// map and the clearance along its branches (the panels of Thesis, figs. 4.8, 4.10, 5.2 and 5.5).
//
// Plans are in the robot frame with x (forward) up and y (left) to the left, at equal scale.
#pragma once

#include <string>

#include "topogeo/render/map_picture.hpp"
#include "topogeo/render/picture_format.hpp"
#include "topogeo/render/scan_view.hpp"

namespace topogeo::render {

/// The bytes of the file, `max_width_px` wide. The same view gives the same SVG bytes. The title
/// contains `log_name`. Throws std::invalid_argument for a width out of range.
std::string scan_picture(const ScanView& view, const std::string& log_name, PictureFormat format,
                         const PictureOptions& options = {});

}  // namespace topogeo::render
