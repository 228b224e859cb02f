#include "topogeo/storage/map_document.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/support/hash.hpp"

namespace topogeo::storage {
namespace {

std::uint64_t session_of(const MapDocument& document) {
  support::Fnv1a hash;
  hash.add("a session without a name");
  hash.add(document.robot_id);
  hash.add(document.seed);
  for (const topomap::LocalMap& map : document.local_maps) {
    hash.add(static_cast<std::uint64_t>(map.stamp_ns));
    hash.add(topomap::content_hash(map));
  }
  return std::max<std::uint64_t>(hash.value(), 1);
}

}  // namespace

std::uint64_t map_id_of(std::uint64_t first_session) {
  support::Fnv1a hash;
  hash.add("the map that a session begins");
  hash.add(first_session);
  return std::max<std::uint64_t>(hash.value(), 1);
}

void name_stops(MapDocument& document) {
  for (topomap::StopPose& stop : document.trajectory.stops) {
    if (stop.local_map_id >= document.local_maps.size()) continue;
    stop.stop = document.local_maps[stop.local_map_id].stop;
  }
}

MapDocument identified(MapDocument document) {
  if (document.local_maps.empty()) return document;
  if (document.local_maps.front().stop.session == 0) {
    const std::uint64_t session = session_of(document);
    for (topomap::LocalMap& map : document.local_maps) map.stop = {session, map.id};
    name_stops(document);
  }
  if (document.map_id == 0) document.map_id = map_id_of(document.local_maps.front().stop.session);
  return document;
}

}  // namespace topogeo::storage
