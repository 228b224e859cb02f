// The whole map of one robot, as map.pb and the map database hold it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "topogeo/storage/map_drawing.hpp"
#include "topogeo/topomap/global_map.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::storage {

struct MapDocument {
  std::string robot_id;
  std::uint64_t seed = 0;
  std::vector<topomap::LocalMap> local_maps;  ///< index = local map id
  topomap::Trajectory trajectory;             ///< at most as many stops as local maps
  std::vector<topomap::LoopClosure> loop_closures;
  topomap::GlobalMap global_map;
  MapDrawing drawing;
};

}  // namespace topogeo::storage
