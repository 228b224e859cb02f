#include "channels/map_view.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "topogeo/planning/room_memory.hpp"
#include "topogeo/planning/zone_middles.hpp"
#include "topogeo/planning/zones.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/hybrid_map_messages.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/hash.hpp"

#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

using messaging::InstanceState;
using messaging::SampleInfo;

/// Assigns few colours, different from those of adjoining rooms, and if possible derived from the
/// name, so that a room keeps its colour while the map grows.
std::vector<std::uint8_t> room_colors(const msg::HybridMap& map) {
  std::vector<std::vector<std::size_t>> neighbours(map.zones().size());
  for (const msg::HybridNode& node : map.nodes()) {
    if (node.zone_a() >= neighbours.size() || node.zone_b() >= neighbours.size()) continue;
    neighbours[node.zone_a()].push_back(node.zone_b());
    neighbours[node.zone_b()].push_back(node.zone_a());
  }
  constexpr std::uint8_t kNone = MapPicture::kColors;
  std::vector<std::uint8_t> colors(neighbours.size(), kNone);
  for (std::size_t zone = 0; zone < colors.size(); ++zone) {
    std::array<int, MapPicture::kColors + 1> used{};
    for (const std::size_t other : neighbours[zone]) ++used.at(colors[other]);
    const auto wanted = support::fnv1a(map.zones()[zone].name().c_str()) % MapPicture::kColors;
    auto best = static_cast<std::uint8_t>(wanted);
    for (std::size_t i = 1; i < MapPicture::kColors && used.at(best) > 0; ++i) {
      const auto next = static_cast<std::uint8_t>((wanted + i) % MapPicture::kColors);
      if (used.at(next) < used.at(best)) best = next;
    }
    colors[zone] = best;
  }
  return colors;
}

/// For each zone, a cell of it away from walls.
std::vector<std::optional<planning::Cell>> middles_of(const MapPicture& picture,
                                                      std::size_t zones) {
  const planning::GridFrame& frame = picture.frame();
  std::vector<planning::ZoneId> zone_of_cell(frame.size(), planning::kNoZone);
  for (std::size_t i = 0; i < zone_of_cell.size(); ++i) {
    if (const auto zone = picture.zone_at(frame.cell_at(i))) zone_of_cell[i] = *zone;
  }
  return planning::middles_of_zones(frame, zone_of_cell, zones);
}

std::string without_capitals(std::string_view text) {
  std::string out(text);
  std::ranges::transform(out, out.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return out;
}

}  // namespace

MapView::MapView(service::Service& service, ChannelHub& hub, OnShown on_shown)
    : service_(service), hub_(hub), on_shown_(std::move(on_shown)) {
  service.subscribe<msg::GridTile>(
      [this](const msg::GridTile& tile, const SampleInfo& info) { put(tile, info); },
      {.of_map = true},
      [this](const SampleInfo& info) {
        if (info.state != InstanceState::kDisposed) return;
        mirror_.remove(info.instance);
        const auto number = numbers_.find(info.instance);
        if (number == numbers_.end()) return;
        squares_.erase(number->second);
        numbers_.erase(number);
      });
  service.subscribe<msg::HybridMap>(
      [this](const msg::HybridMap& map, const SampleInfo& info) { put(map, info); },
      {.of_map = true},
      [this](const SampleInfo& info) {
        if (info.state == InstanceState::kDisposed) mirror_.remove_summary();
      });
}

void MapView::put(const msg::GridTile& tile, const SampleInfo& info) {
  mirror_.put(tile, info.instance);
  auto square = std::make_shared<GridSquare>();
  square->version = tile.version();
  square->states.assign(tile.states().begin(), tile.states().end());
  square->zones.assign(tile.zones().begin(), tile.zones().end());
  squares_[tile.tile()] = std::move(square);
  numbers_[info.instance] = tile.tile();
  show();
}

void MapView::put(const msg::HybridMap& summary, const SampleInfo& info) {
  mirror_.put(summary);
  summary_ = summary;
  writer_ = info.writer;
  show();
}

std::vector<std::shared_ptr<const GridSquare>> MapView::squares_if_whole() const {
  std::vector<std::shared_ptr<const GridSquare>> squares;
  const auto& versions = summary_->tile_versions();
  if (squares_.size() < versions.size()) return {};
  squares.reserve(versions.size());
  for (std::uint32_t number = 0; number < versions.size(); ++number) {
    const auto found = squares_.find(number);
    if (found == squares_.end() || found->second->version != versions[number]) return {};
    squares.push_back(found->second);
  }
  return squares;
}

void MapView::show() {
  if (!summary_ || summary_->tile_versions().empty()) return;
  std::vector<std::shared_ptr<const GridSquare>> squares = squares_if_whole();
  if (squares.empty()) return;
  const planning::GridFrame frame = service::frame_from_msg(*summary_);
  support::Fnv1a hash;
  for (const double value : {frame.T_map_grid.x_m, frame.T_map_grid.y_m, frame.T_map_grid.theta_rad,
                             frame.resolution_m}) {
    hash.add(fmt::format("{} ", value));
  }
  hash.add(static_cast<std::uint64_t>(frame.columns));
  for (const std::uint8_t byte : writer_.bytes) hash.add(std::uint64_t{byte});
  const std::string name = fmt::format("{:08x}", hash.value() >> 32U);
  const bool anew = !shown_ || shown_->frame != name;

  const std::vector<std::uint8_t> colors = room_colors(*summary_);
  auto shown = std::make_shared<ShownMap>();
  shown->frame = name;
  shown->version = summary_->version();
  for (const msg::HybridZone& zone : summary_->zones()) {
    shown->rooms.push_back(text_of_message(zone.name()));
  }
  shown->picture = std::make_shared<const MapPicture>(frame, squares, colors);
  {
    const std::scoped_lock lock(mutex_);
    shown_ = shown;
  }
  if (on_shown_) on_shown_(shown->picture);
  show_frame(name);
  show_tiles(squares, anew);
  show_rooms(*shown->picture, colors);
  show_drawing();
  service_.status().set_counter("map_version", static_cast<double>(summary_->version()));
}

std::shared_ptr<const ShownMap> MapView::shown() const {
  const std::scoped_lock lock(mutex_);
  return shown_;
}

void MapView::show_frame(const std::string& frame) {
  Json json = {{"version", std::to_string(summary_->version())},
               {"columns", summary_->columns()},
               {"rows", summary_->rows()},
               {"resolution_m", summary_->resolution_m()},
               {"frame", frame}};
  const geometry::Pose2 T_map_grid = service::from_msg(summary_->T_map_grid());
  json["x_m"] = exact(T_map_grid.x_m);
  json["y_m"] = exact(T_map_grid.y_m);
  json["theta_rad"] = exact(T_map_grid.theta_rad);
  hub_.set(Channel::kMap, text_of(json));
}

void MapView::show_tiles(const std::vector<std::shared_ptr<const GridSquare>>& squares, bool anew) {
  std::vector<Edit> edits;
  for (std::size_t number = 0; number < squares.size(); ++number) {
    if (!squares[number]->is_known()) continue;
    edits.push_back({std::to_string(number), std::to_string(squares[number]->version)});
  }
  if (anew) hub_.edit(Channel::kTiles, {}, true);
  hub_.edit(Channel::kTiles, std::move(edits), true);
}

std::string room_name(const msg::HybridZone& room, const msg::HybridMap& map) {
  const std::string name = text_of_message(room.name());
  const bool is_place = std::ranges::any_of(
      map.places(), [&](const msg::HybridPlace& place) { return place.name() == room.name(); });
  return is_place && room.room() != 0 ? planning::room_name(room.room()) : name;
}

void MapView::show_rooms(const MapPicture& picture, const std::vector<std::uint8_t>& colors) {
  const auto middles = middles_of(picture, summary_->zones().size());
  std::vector<Edit> edits;
  names_.clear();
  for (std::size_t zone = 0; zone < middles.size(); ++zone) {
    if (!middles[zone]) continue;
    const msg::HybridZone& room = summary_->zones()[zone];
    const Eigen::Vector2d middle_m = picture.frame().center_m(*middles[zone]);
    const std::string name = room_name(room, *summary_);
    if (!name.empty()) names_.push_back({false, name, middle_m});
    edits.push_back({std::to_string(zone), text_of(Json{{"name", name},
                                                        {"area_m2", rounded(room.area_m2())},
                                                        {"x_m", rounded(middle_m.x())},
                                                        {"y_m", rounded(middle_m.y())},
                                                        {"color", colors[zone]}})});
  }
  hub_.edit(Channel::kRooms, std::move(edits), true);
}

void MapView::show_drawing() {
  std::vector<Edit> places;
  for (const msg::HybridPlace& place : summary_->places()) {
    const Eigen::Vector2d at_m(place.position().x_m(), place.position().y_m());
    names_.push_back({true, text_of_message(place.name()), at_m});
    places.push_back({text_of_message(place.name()),
                      text_of(Json{{"x_m", rounded(at_m.x())}, {"y_m", rounded(at_m.y())}})});
  }
  hub_.edit(Channel::kPlaces, std::move(places), true);
  std::vector<Edit> rules;
  for (const msg::HybridRule& rule : summary_->rules()) {
    const std::optional<planning::ZoneKind> kind = service::zone_of_rule(rule.kind());
    if (!kind) continue;  // walls and the like are in the drawing
    Json corners = Json::array();
    for (const msg::Point2& corner : rule.corners()) {
      corners.push_back(rounded(corner.x_m()));
      corners.push_back(rounded(corner.y_m()));
    }
    rules.push_back(
        {text_of_message(rule.name()), text_of(Json{{"kind", planning::to_string(*kind)},
                                                    {"value", exact(rule.value())},
                                                    {"corners_m", std::move(corners)}})});
  }
  hub_.edit(Channel::kRules, std::move(rules), true);
}

std::optional<NamedPoint> MapView::find(std::string_view name) const {
  // Places before rooms, exact names before others.
  for (const bool exactly : {true, false}) {
    for (const bool place : {true, false}) {
      const NamedPoint* found = nullptr;
      int count = 0;
      for (const NamedPoint& point : names_) {
        if (point.place != place) continue;
        const bool same =
            exactly ? point.name == name : without_capitals(point.name) == without_capitals(name);
        if (!same) continue;
        found = &point;
        ++count;
      }
      if (count == 1) return *found;
    }
  }
  return std::nullopt;
}

}  // namespace topogeo::web
