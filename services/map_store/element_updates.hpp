// Finds the map elements to send so that readers have the newest state.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/msg/map_update.h"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::map_store {

/// Remembers the elements sent of one robot's map.
class ElementUpdates {
 public:
  explicit ElementUpdates(std::string robot_id) : robot_id_(std::move(robot_id)) {}

  struct Update {
    std::vector<msg::MapElement> gone;     ///< to be disposed first
    std::vector<msg::MapElement> changed;  ///< to be written, the summary last
  };
  /// Unchanged elements are left out. `stamp_ns` is that of the last stop in the map. Call number()
  /// for each element before sending it, and report each with sent() or disposed(). Send the
  /// summary after all others.
  [[nodiscard]] Update update_to(const topomap::GlobalMap& map, std::uint64_t map_id,
                                 std::int64_t stamp_ns) const;

  /// Gives an element its number, and a summary the hash of the samples sent before it.
  void number(msg::MapElement& element) const;
  void sent(const msg::MapElement& element);
  void disposed(const msg::MapElement& element);
  /// Number of elements sent so far: the sequence number of the next one.
  [[nodiscard]] std::uint64_t count() const { return count_; }

 private:
  using Key = std::pair<msg::MapElementKind, std::uint32_t>;
  static Key key_of(const msg::MapElement& element) { return {element.kind(), element.id()}; }
  /// Only hashes, because whole elements of a large map take twenty megabytes.
  struct Sent {
    std::uint64_t content = 0;
    std::uint64_t sample = 0;  // map_client::sample_hash; 0 for the summary
  };
  void forget(const Key& key);

  std::string robot_id_;
  std::map<Key, Sent> sent_;
  std::uint64_t count_ = 0;
  std::uint64_t samples_hash_ = 0;  // of nodes and branches in sent_
};

}  // namespace topogeo::map_store
