// The local maps that a worker holds, by content: robots of several runs may give other maps the
// same id.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <unordered_map>

#include "topogeo/search_pool/match_job.hpp"

namespace topogeo::search_pool {

/// About what a map takes in memory, bytes.
std::size_t bytes_of(const topomap::LocalMap& map);

/// Drops the least recently used maps when they take more than `capacity_bytes`; the one added last
/// always stays. Whoever got a map keeps it. Not safe for several threads.
class MapCache {
 public:
  explicit MapCache(std::size_t capacity_bytes) : capacity_bytes_(capacity_bytes) {}

  /// `hash` is topomap::content_hash of the map.
  void add(std::uint64_t hash, MapPointer map);
  /// The map of this content, now the most recently used one; null when it is not there.
  MapPointer find(std::uint64_t hash);

  [[nodiscard]] std::size_t size() const { return maps_.size(); }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// Maps that had to make room since the start.
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
