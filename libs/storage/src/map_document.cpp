#include "topogeo/storage/map_document.hpp"

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
  return hash.value();
}

}  // namespace

std::uint64_t map_id_of(std::uint64_t first_session) {
  support::Fnv1a hash;
  hash.add("the map that a session begins");
  hash.add(first_session);
  return hash.value() == 0 ? 1 : hash.value();
}

MapDocument identified(MapDocument document) {
  if (document.local_maps.empty()) return document;
  if (document.sources.empty()) {
    const std::uint64_t session = session_of(document);
    for (const topomap::LocalMap& map : document.local_maps) {
      document.sources.push_back({session, map.id});
    }
  }
  if (document.map_id == 0) document.map_id = map_id_of(document.sources.front().session);
  return document;
}

}  // namespace topogeo::storage
