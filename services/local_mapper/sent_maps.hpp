// Keeps sent local maps for readers that come late.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "topogeo/topomap/local_map.hpp"

namespace topogeo::local_mapper {

struct SentMapsLimits {
  /// Number of stored maps kept nevertheless, about 4 MB: a reader slightly behind gets them
  /// without asking the map store.
  std::size_t stored = 256;
  /// Largest number kept, about 60 MB: as many as a map store that cannot write keeps in memory.
  std::size_t unstored = 4096;
};

class SentMaps {
 public:
  explicit SentMaps(const SentMapsLimits& limits = {}) : limits_(limits) {}

  void add(const topomap::StopId& stop) { sent_.push_back(stop); }
  /// Stops 0 to `stops` - 1 of that session are stored.
  void set_stored(std::uint64_t session, std::uint32_t stops);
  /// There is a map store, but it stores nothing. Late readers go on without the older maps.
  void set_nothing_stored() { nothing_stored_ = true; }

  /// True when nothing is stored and more than SentMapsLimits::stored maps are held: the state of
  /// the readers then decides which ones go.
  [[nodiscard]] bool depends_on_readers() const {
    return nothing_stored_ && sent_.size() > limits_.stored;
  }
  /// Removes and returns the maps not kept any more, oldest first. `readers_have_all`: all
  /// connected readers have received all maps.
  std::vector<topomap::StopId> take_old(bool readers_have_all);
  [[nodiscard]] std::size_t size() const { return sent_.size(); }

 private:
  [[nodiscard]] bool is_stored(const topomap::StopId& stop) const;

  SentMapsLimits limits_;
  std::deque<topomap::StopId> sent_;  // oldest first
  std::uint64_t session_ = 0;         // of the stored maps ...
  std::uint32_t stops_ = 0;           // ... its stops with smaller numbers
  bool nothing_stored_ = false;
};

}  // namespace topogeo::local_mapper
