// The hybrid map on the hub: grid, rooms, places, rules, its pictures, and the map itself for
// routes.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "topogeo/msg/hybrid_map.h"
#include "topogeo/service/hybrid_map_mirror.hpp"
#include "topogeo/service/service.hpp"

#include "channels/map_picture.hpp"
#include "server/channel_hub.hpp"

namespace topogeo::web {

/// A room or a place, by its name.
struct NamedPoint {
  bool place = false;                                    ///< otherwise a room
  std::string name;                                      ///< as spelled in the map
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< map frame; for a room, well inside it
};

/// The version of the map that is shown. Thread-safe.
struct ShownMap {
  std::string
      frame;  ///< 8 hexadecimal digits; changes with the grid and with a restart of the map store
  std::uint64_t version = 0;
  std::vector<std::string> rooms;  ///< names, by zone
  std::shared_ptr<const MapPicture> picture;
};

/// The name of a room for people. A room that is named after the place in it keeps its number as
/// its name, so that both can be chosen.
std::string room_name(const msg::HybridZone& room, const msg::HybridMap& map);

/// Lives in the loop of its service, except shown().
class MapView {
 public:
  /// `on_shown` gets each version shown; may be empty.
  using OnShown = std::function<void(const std::shared_ptr<const MapPicture>&)>;
  MapView(service::Service& service, ChannelHub& hub, OnShown on_shown = {});

  /// Null before the first complete map. Thread-safe.
  [[nodiscard]] std::shared_ptr<const ShownMap> shown() const;
  /// Its picture, likewise.
  [[nodiscard]] std::shared_ptr<const MapPicture> picture() const {
    const auto shown_now = shown();
    return shown_now ? shown_now->picture : nullptr;
  }
  /// For routes; null before the first map. Throws std::invalid_argument like HybridMapMirror::map.
  std::shared_ptr<const planning::HybridMap> map() { return mirror_.map(); }
  /// A place, or else a room; case (A to Z) matters only between names that differ in nothing else.
  [[nodiscard]] std::optional<NamedPoint> find(std::string_view name) const;

 private:
  void put(const msg::GridTile& tile, const messaging::SampleInfo& info);
  void put(const msg::HybridMap& summary, const messaging::SampleInfo& info);
  /// Shows the map if it is complete.
  void show();
  [[nodiscard]] std::vector<std::shared_ptr<const GridSquare>> squares_if_whole() const;
  void show_frame(const std::string& frame);
  void show_tiles(const std::vector<std::shared_ptr<const GridSquare>>& squares, bool anew);
  void show_rooms(const MapPicture& picture, const std::vector<std::uint8_t>& colors);
  void show_drawing();

  service::Service& service_;
  ChannelHub& hub_;
  OnShown on_shown_;
  service::HybridMapMirror mirror_;
  std::map<std::uint32_t, std::shared_ptr<const GridSquare>> squares_;
  std::map<messaging::Handle, std::uint32_t> numbers_;
  std::optional<msg::HybridMap> summary_;
  messaging::Handle writer_;  // writer of the summary
  std::vector<NamedPoint> names_;
  mutable std::mutex mutex_;
  std::shared_ptr<const ShownMap> shown_;
};

}  // namespace topogeo::web
