// The live hybrid map of one robot, kept from its tiles and its summary, which may come in any
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
  /// Takes a tile in place of the one of its number. Throws std::invalid_argument naming the field
  /// when it has another count of cells than msg::kTileArea, a state that does not exist or a
  /// number out of range; the mirror is then as before.
  void put(const msg::GridTile& tile, messaging::Handle instance);

  /// Takes a summary in place of the one before. Throws std::invalid_argument naming the field when
  /// it contradicts itself: a frame or inflation out of range (see planning::check), another count
  /// of tiles than the frame has, a name that is empty or taken, a zone or node that does not
  /// exist, a number that is not finite; the mirror is then as before.
  void put(const msg::HybridMap& summary);

  /// Takes out the tile of an instance that was disposed; one never put is no error.
  void remove(messaging::Handle instance);

  /// The summary was disposed: there is no map until the next one is whole.
  void remove_summary();

  /// The newest map that was whole: every tile of the grid was here with the version of the
  /// summary. Null before the first. While an update is under way this is the map before it.
  /// It is built here, once for each change, which takes tens of milliseconds for a large map.
  /// Throws std::invalid_argument, once, when a whole map contradicts itself (a cell in a zone that
  /// does not exist, or in none though the robot may be there); the one before then stays.
  std::shared_ptr<const planning::HybridMap> map();

  /// Of what the last call of map() gave; 0: none.
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
