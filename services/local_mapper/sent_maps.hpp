// Which of the local maps that were sent are kept for readers that come late.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "topogeo/topomap/local_map.hpp"

namespace topogeo::local_mapper {

struct SentMapsLimits {
  /// So many are kept though they are stored, about 4 MB: a reader that is a little behind has them
  /// without asking the map store.
  std::size_t stored = 256;
  /// So many are kept at most, about 60 MB: what a map store keeps in memory that cannot store.
  std::size_t unstored = 4096;
};

class SentMaps {
 public:
  explicit SentMaps(const SentMapsLimits& limits = {}) : limits_(limits) {}

  void add(const topomap::StopId& stop) { sent_.push_back(stop); }
  /// Stops 0 to `stops` - 1 of that session are stored.
  void set_stored(std::uint64_t session, std::uint32_t stops);
  /// There is a map store, but what comes is not stored. Whoever comes late goes on without.
  void set_nothing_stored() { nothing_stored_ = true; }

  /// Of maps that are not stored more than those have to be kept that late readers may want.
  [[nodiscard]] bool depends_on_readers() const {
    return nothing_stored_ && sent_.size() > limits_.stored;
  }
  /// Those that are not kept any more, oldest first; they are forgotten here. `readers_have_all`:
  /// all readers that are connected have all.
  std::vector<topomap::StopId> take_old(bool readers_have_all);
  [[nodiscard]] std::size_t size() const { return sent_.size(); }

 private:
  [[nodiscard]] bool is_stored(const topomap::StopId& stop) const;

  SentMapsLimits limits_;
  std::deque<topomap::StopId> sent_;  // oldest first
  std::uint64_t session_ = 0;         // of what is stored ...
  std::uint32_t stops_ = 0;           // ... its stops before this one
  bool nothing_stored_ = false;
};

}  // namespace topogeo::local_mapper
