// Contents of graph formats: nodes, branches, places and zones.
#pragma once

#include "topogeo/exchange/output_file.hpp"
#include "topogeo/storage/map_drawing.hpp"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::exchange {

struct MapGraph {
  topomap::GlobalMap map;
  storage::MapDrawing drawing;  ///< with a grid only if the format has one
  Notes notes;
};

}  // namespace topogeo::exchange
