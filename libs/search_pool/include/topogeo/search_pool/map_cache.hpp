// The local maps of a worker, by content: robots of several runs may use the same id for different
// maps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <unordered_map>

#include "topogeo/search_pool/match_job.hpp"

namespace topogeo::search_pool {

/// Approximate memory of a map, bytes.
std::size_t bytes_of(const topomap::LocalMap& map);

/// Drops the least recently used maps if all together exceed `capacity_bytes`; the last added one
/// always stays. A map already handed out stays valid. Not thread-safe.
class MapCache {
 public:
  explicit MapCache(std::size_t capacity_bytes) : capacity_bytes_(capacity_bytes) {}

  /// `hash` is topomap::content_hash of the map.
  void add(std::uint64_t hash, MapPointer map);
  /// The map with this content, which becomes the most recently used one; null if it is not cached.
  MapPointer find(std::uint64_t hash);

  [[nodiscard]] std::size_t size() const { return maps_.size(); }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// Number of maps dropped since the start.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  struct Held {
    std::uint64_t hash = 0;
    MapPointer map;
    std::size_t bytes = 0;
  };

  std::size_t capacity_bytes_;
  std::list<Held> used_;  // most recently used first
  std::unordered_map<std::uint64_t, std::list<Held>::iterator> maps_;
  std::size_t bytes_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace topogeo::search_pool
