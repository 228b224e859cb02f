// A picture of a hybrid map with a planned route, before the robot drives it.
#pragma once

#include <span>
#include <string>

#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/render/map_picture.hpp"
#include "topogeo/render/picture_format.hpp"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::render {

/// The bytes of the file, `max_width_px` wide: obstacles dark, forbidden cells grey, each zone in a
/// pale tint, border nodes, named places, base stations with the arrow of their heading, and the
/// straightened route in red from a ring to a disc. The cells in `filled`, with obstacles that are
/// not on the map, are orange. The grid is drawn in its own frame, x to the right. `graph`: the
/// branches of the same map, in blue. Parts of the route on virtual branches are dashed, parts off
/// the branches dotted. If no `route` was found, only the map is drawn. The same input gives the
/// same SVG bytes. Throws std::invalid_argument for a width out of range.
std::string route_picture(const planning::HybridMap& map, const planning::HybridRoute& route,
                          const std::string& title, PictureFormat format,
                          const PictureOptions& options = {},
                          std::span<const planning::Cell> filled = {},
                          const topomap::GlobalMap* graph = nullptr);

}  // namespace topogeo::render
