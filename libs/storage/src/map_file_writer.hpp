// Writes the bytes of a map file in sequence, so that a map need not be in memory twice.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "topogeo/storage/map_document.hpp"
#include "topogeo/support/hash.hpp"

#include "map_conversions.hpp"

namespace topogeo::storage {

/// Writes fields in the order of their numbers, like Protobuf: the same bytes whether a map comes
/// in one piece or in many.
class MapFileWriter {
 public:
  using Sink = std::function<void(std::string_view)>;

  MapFileWriter(Sink sink, const std::string& robot_id, std::uint64_t seed);
  /// The next local map.
  void add(const topomap::LocalMap& map);
  /// Writes everything except the local maps, and the checksum. The last call.
  void finish(const MapDocument& rest);

 private:
  void write(const proto::MapFile& fields);

  Sink sink_;
  support::Fnv1a hash_;
};

}  // namespace topogeo::storage
