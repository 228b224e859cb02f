// The live hybrid map of one robot, assembled from its tiles and summary, which may arrive in any
// order.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "topogeo/messaging/events.hpp"
#include "topogeo/msg/hybrid_map.h"
#include "topogeo/planning/hybrid_map.hpp"

namespace topogeo::service {

class HybridMapMirror {
 public:
  /// Replaces the tile of the same number. Throws std::invalid_argument naming the field when the
  /// number of cells is not msg::kTileArea, a state does not exist or a number is out of range; the
  /// mirror is then unchanged.
  void put(const msg::GridTile& tile, messaging::Handle instance);

  /// Replaces the summary. Throws std::invalid_argument naming the field when the summary
  /// contradicts itself: a frame or inflation out of range (see planning::check), a number of tiles
  /// that does not match the frame, a name that is empty or taken, a zone or node that does not
  /// exist, a number that is not finite; the mirror is then unchanged.
  void put(const msg::HybridMap& summary);

  /// Removes the tile of a disposed instance; an instance never put is no error.
  void remove(messaging::Handle instance);

  /// The summary was disposed: there is no map until the next one is whole.
  void remove_summary();

  /// The newest complete map: every tile of the grid was here with the version of the summary. Null
  /// before the first; during an update, the map before it. The map is built here, once for each
  /// change, which takes tens of milliseconds for a large map. Throws std::invalid_argument, once,
  /// when a complete map contradicts itself (a cell in a zone that does not exist, or a free cell
  /// in no zone); the previous map then stays.
  std::shared_ptr<const planning::HybridMap> map();

  /// Version of the map that map() last returned; 0: none.
  [[nodiscard]] std::uint64_t version() const { return version_; }

 private:
  struct Tile {
    std::uint64_t version = 0;
    std::vector<std::uint8_t> states;
    std::vector<std::uint16_t> zones;
  };

  [[nodiscard]] bool whole() const;
  [[nodiscard]] std::shared_ptr<const planning::HybridMap> build() const;

  std::map<messaging::Handle, std::uint32_t> keys_;
  std::map<std::uint32_t, Tile> tiles_;
  std::optional<msg::HybridMap> summary_;
  bool changed_ = false;  // since the last map was built, or could not be
  std::shared_ptr<const planning::HybridMap> map_;
  std::uint64_t version_ = 0;
};

}  // namespace topogeo::service
