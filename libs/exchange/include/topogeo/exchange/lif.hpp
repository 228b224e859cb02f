// The map in the Layout Interchange Format 1.0.0 of the VDMA (docs/exchange.md, "LIF").
#pragma once

#include <string>
#include <string_view>

#include "topogeo/exchange/export_header.hpp"
#include "topogeo/exchange/map_graph.hpp"
#include "topogeo/exchange/route_network.hpp"
#include "topogeo/storage/map_drawing.hpp"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::exchange {

struct LifText {
  std::string text;
  Notes notes;
};

/// Nodes n<id>, edges b<id>+ and b<id>- with the polyline as trajectory of degree 1, places as
/// stations at the nearest node that has an edge. Leaves out branches that are narrower than
/// `settings.robot_radius_m` at any point, that lead back to their own node or that zones forbid.
/// The tolerance is not used.
LifText lif_text(const topomap::GlobalMap& map, const storage::MapDrawing& drawing,
                 const NetworkSettings& settings, const ExportHeader& header);

/// Reads the first layout of a file of version 1.0.0, or of the draft of 2.0. Trajectories of other
/// degrees become polylines. Throws std::runtime_error naming the file, the field and the
/// expectation.
MapGraph parse_lif(std::string_view text, const std::string& name);

}  // namespace topogeo::exchange
