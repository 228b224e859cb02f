#include "orders/drawing_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "topogeo/planning/zones.hpp"
#include "topogeo/service/drawing_conversions.hpp"
#include "topogeo/support/format.hpp"

#include "orders/json_reading.hpp"

namespace topogeo::web {
namespace {

constexpr double kFarthestDrawn_m = 1e6;
constexpr double kDrawnTurn_rad = 2.0 * std::numbers::pi;
constexpr std::size_t kMostRooms = 256;  // in one join

Json flat_list(const std::vector<Eigen::Vector2d>& points_m) {
  Json out = Json::array();
  for (const Eigen::Vector2d& point_m : points_m) {
    out.push_back(exact(point_m.x()));
    out.push_back(exact(point_m.y()));
  }
  return out;
}

std::vector<Eigen::Vector2d> points_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array() || found->size() % 2 != 0) {
    throw std::invalid_argument(fmt::format("{}: expected a list [x, y, x, y, ...]", key));
  }
  std::vector<Eigen::Vector2d> points_m;
  for (std::size_t i = 0; i < found->size(); i += 2) {
    if (!(*found)[i].is_number() || !(*found)[i + 1].is_number()) {
      throw std::invalid_argument(fmt::format("{}: expected numbers", key));
    }
    points_m.emplace_back((*found)[i].get<double>(), (*found)[i + 1].get<double>());
  }
  return points_m;
}

std::string text_in(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end()) return {};
  if (!found->is_string()) throw std::invalid_argument(fmt::format("{}: expected a text", key));
  return found->get<std::string>();
}

/// Calls `use` for each entry of a list; its errors get list, index and name.
template <class Use>
void for_each_entry(const Json& json, const char* list, const Use& use) {
  const auto found = json.find(list);
  if (found == json.end()) return;
  if (!found->is_array()) throw std::invalid_argument(fmt::format("{}: expected a list", list));
  for (std::size_t i = 0; i < found->size(); ++i) {
    const Json& entry = (*found)[i];
    const std::string at = fmt::format("{}[{}]", list, i);
    if (!entry.is_object()) throw std::invalid_argument(at + ": expected an object");
    try {
      use(entry);
    } catch (const std::invalid_argument& error) {
      const auto name = entry.find("name");
      const bool named = name != entry.end() && name->is_string();
      throw std::invalid_argument(fmt::format(
          "{}{}: {}", at, named ? " '" + name->get<std::string>() + "'" : "", error.what()));
    }
  }
}

planning::Place place_of(const Json& json) {
  planning::Place place;
  place.name = text_in(json, "name");
  place.position_m = {needed(json, "x_m", -kFarthestDrawn_m, kFarthestDrawn_m),
                      needed(json, "y_m", -kFarthestDrawn_m, kFarthestDrawn_m)};
  if (const auto heading = number(json, "heading_rad", -kDrawnTurn_rad, kDrawnTurn_rad)) {
    place.station_heading_rad = geometry::wrap_angle(*heading);
  }
  return place;
}

planning::DrawnZone zone_of(const Json& json) {
  const auto kind = planning::zone_kind_of(text_in(json, "kind"));
  if (!kind) {
    throw std::invalid_argument("kind: expected room, no_go, slow, one_way or preferred");
  }
  planning::DrawnZone zone{text_in(json, "name"), points_of(json, "corners_m"), *kind};
  if (*kind == planning::ZoneKind::kSlow) {
    zone.value = needed(json, "value", 0.0, std::numeric_limits<double>::max());
  }
  if (*kind == planning::ZoneKind::kOneWay) {
    zone.value = geometry::wrap_angle(needed(json, "value", -kDrawnTurn_rad, kDrawnTurn_rad));
  }
  return zone;
}

/// All lists, as version 0.
storage::MapDrawing content_of(const Json& json) {
  storage::MapDrawing drawing;
  for_each_entry(json, "places",
                 [&](const Json& entry) { drawing.places.push_back(place_of(entry)); });
  for_each_entry(json, "zones",
                 [&](const Json& entry) { drawing.zones.push_back(zone_of(entry)); });
  for (const auto kind :
       {planning::LineKind::kWall, planning::LineKind::kOpening, planning::LineKind::kDoor}) {
    for_each_entry(json, storage::list_of(kind), [&](const Json& entry) {
      drawing.lines.push_back({kind, points_of(entry, "points_m"), text_in(entry, "name")});
    });
  }
  service::check_drawing(drawing);
  return drawing;
}

std::uint64_t version_of(const Json& json) {
  const std::string text = text_in(json, "version");
  std::uint64_t version = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), version);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) {
    throw std::invalid_argument("version: expected that of the drawing that was edited, a text");
  }
  return version;
}

}  // namespace

Json json_of(const storage::MapDrawing& drawing) {
  Json json = {{"version", std::to_string(drawing.version)}};
  Json places = Json::array();
  for (const planning::Place& place : drawing.places) {
    Json entry = {{"name", place.name},
                  {"x_m", exact(place.position_m.x())},
                  {"y_m", exact(place.position_m.y())}};
    if (place.station_heading_rad) entry["heading_rad"] = exact(*place.station_heading_rad);
    places.push_back(std::move(entry));
  }
  json["places"] = std::move(places);
  Json zones = Json::array();
  for (const planning::DrawnZone& zone : drawing.zones) {
    zones.push_back({{"name", zone.name},
                     {"kind", planning::to_string(zone.kind)},
                     {"value", exact(zone.value)},
                     {"corners_m", flat_list(zone.polygon_m)}});
  }
  json["zones"] = std::move(zones);
  for (const auto kind :
       {planning::LineKind::kWall, planning::LineKind::kOpening, planning::LineKind::kDoor}) {
    json[storage::list_of(kind)] = Json::array();
  }
  for (const planning::DrawnLine& line : drawing.lines) {
    Json entry = Json::object();
    if (!line.name.empty()) entry["name"] = line.name;
    entry["points_m"] = flat_list(line.points_m);
    json[storage::list_of(line.kind)].push_back(std::move(entry));
  }
  return json;
}

storage::MapDrawing parse_drawing(const std::string& body) {
  const Json json = object_of(body);
  storage::MapDrawing drawing = content_of(json);
  service::check_rules(drawing);
  drawing.version = version_of(json);
  return drawing;
}

ShapesOrder parse_shapes_order(const std::string& body) {
  const Json json = object_of(body);
  const auto zones = json.find("zones");
  if (zones == json.end() || !zones->is_array() || zones->empty() || zones->size() > kMostRooms) {
    throw std::invalid_argument("zones: expected a list of 1 to 256 indices");
  }
  ShapesOrder order;
  for (const Json& zone : *zones) {
    constexpr std::uint64_t kLast = 65534;
    if (!zone.is_number_unsigned() || zone.get<std::uint64_t>() > kLast) {
      throw std::invalid_argument("zones: expected indices of channel rooms");
    }
    order.zones.push_back(zone.get<std::uint16_t>());
  }
  if (!json.contains("cut_m")) return order;
  const std::vector<Eigen::Vector2d> cut_m = points_of(json, "cut_m");
  const auto is_far = [](const Eigen::Vector2d& point_m) {
    return !(point_m.cwiseAbs().maxCoeff() <= kFarthestDrawn_m);
  };
  if (cut_m.size() != 2 || cut_m[0] == cut_m[1] || is_far(cut_m[0]) || is_far(cut_m[1])) {
    throw std::invalid_argument("cut_m: expected two points that differ");
  }
  order.cut_m.emplace(cut_m[0], cut_m[1]);
  return order;
}

FloorText parse_floor(const std::string& body) {
  const Json json = object_of(body);
  FloorText floor;
  const std::string target = text_in(json, "target");
  if (target != "simulator" && target != "robot") {
    throw std::invalid_argument("target: expected simulator or robot");
  }
  floor.simulator = target == "simulator";
  floor.name = text_in(json, "name");
  if (floor.name.size() > storage::kMaxNameBytes) {
    throw std::invalid_argument("name: expected at most 64 bytes");
  }
  const auto start = json.find("start");
  if (start == json.end() || !start->is_object()) {
    throw std::invalid_argument("start: expected x_m, y_m and heading_rad");
  }
  floor.T_floor_start = {
      needed(*start, "x_m", -kFarthestDrawn_m, kFarthestDrawn_m),
      needed(*start, "y_m", -kFarthestDrawn_m, kFarthestDrawn_m),
      geometry::wrap_angle(
          number(*start, "heading_rad", -kDrawnTurn_rad, kDrawnTurn_rad).value_or(0.0))};
  floor.drawing = content_of(json);
  const bool has_wall = std::ranges::any_of(
      floor.drawing.lines, [](const auto& line) { return line.kind == planning::LineKind::kWall; });
  if (!has_wall) throw std::invalid_argument("walls: a floor needs at least one");
  return floor;
}

}  // namespace topogeo::web
