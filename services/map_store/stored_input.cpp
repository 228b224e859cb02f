#include "stored_input.hpp"

#include <utility>

#include "topogeo/pipeline/hybrid_map_source.hpp"

namespace topogeo::map_store {

MapInput::Stored stored_input(const storage::MapDatabase& database, storage::MapDrawing& drawing,
                              std::optional<topomap::GlobalMap>& shown,
                              planning::RoomMemory& rooms) {
  storage::MapDocument document = database.load();
  rooms = std::move(document.rooms);
  if (!document.global_map.nodes.empty()) shown = std::move(document.global_map);
  if (document.drawing.version == 0) pipeline::lay_over(document.drawing, std::move(drawing));
  drawing = std::move(document.drawing);
  MapInput::Stored stored;
  stored.local_maps = std::move(document.local_maps);
  stored.trajectory = std::move(document.trajectory);
  stored.closures = std::move(document.loop_closures);
  stored.edges = std::move(document.edges);
  stored.refused_merges = std::move(document.refused_merges);
  for (const topomap::StopId& stop : database.waiting_stops()) {
    if (auto map = database.stop(stop)) stored.waiting.push_back(std::move(*map));
  }
  for (const storage::SessionState& session : database.sessions()) {
    stored.first_kept[session.id] = session.first_kept;
  }
  return stored;
}

}  // namespace topogeo::map_store
