// The YAML file of drawn zones and named places.
#include <array>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "topogeo/planning/zones.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/yaml_reader.hpp"

#include "text_file.hpp"

namespace topogeo::planning {
namespace {

using support::YamlNode;

/// 1,000 km, beyond any site: a larger coordinate is a mistake.
constexpr double kMaxDrawn_m = 1e6;

std::string new_name(const YamlNode& node, std::set<std::string>& taken) {
  std::string name = node.text();
  if (name.empty()) node.fail("a non-empty text");
  if (!taken.insert(name).second) node.fail("each name once");
  return name;
}

Eigen::Vector2d drawn_point_of(const YamlNode& node) {
  const std::vector<YamlNode> items = node.tuple(2, "[x, y]");
  return {items[0].number(-kMaxDrawn_m, kMaxDrawn_m, "m"),
          items[1].number(-kMaxDrawn_m, kMaxDrawn_m, "m")};
}

std::vector<Eigen::Vector2d> polygon_of(const YamlNode& node) {
  constexpr std::size_t kLeastCorners = 3;
  std::vector<Eigen::Vector2d> corners;
  if (node.is_list()) {
    for (const YamlNode& corner : node.items()) corners.push_back(drawn_point_of(corner));
  }
  if (corners.size() < kLeastCorners) node.fail("a list of three corners [x, y] or more");
  return corners;
}

constexpr std::array<const char*, kZoneKinds> kKindNames{"room", "no_go", "slow", "one_way",
                                                         "preferred"};

ZoneKind kind_of(const YamlNode& node) {
  if (!node.exists()) return ZoneKind::kRoom;
  const std::optional<ZoneKind> kind = zone_kind_of(node.text());
  if (!kind) node.fail("room, no_go, slow, one_way or preferred");
  return *kind;
}

double value_of(const YamlNode& node, ZoneKind kind) {
  if (kind == ZoneKind::kSlow) return node.number(kLeastZoneSpeed_m_s, kMostZoneSpeed_m_s, "m/s");
  if (kind == ZoneKind::kOneWay) return node.number(-std::numbers::pi, std::numbers::pi, "rad");
  if (node.exists()) node.fail("no value: only slow and one_way zones have one");
  return 0.0;
}

constexpr std::array<const char*, kLineKinds> kLineLists{"walls", "openings", "doors"};
constexpr std::array<const char*, kLineKinds> kLineWords{"a wall", "an opening", "a door"};

DrawnLine line_of(const YamlNode& node, LineKind kind, std::set<std::string>& taken) {
  node.allow_keys({"name", "points"});
  DrawnLine line{kind, {}, {}};
  const YamlNode name = node.at("name");
  if (kind == LineKind::kDoor || name.exists()) line.name = new_name(name, taken);
  const YamlNode points = node.at("points");
  if (points.is_list()) {
    for (const YamlNode& point : points.items()) line.points_m.push_back(drawn_point_of(point));
  }
  const bool wall = kind == LineKind::kWall;
  if (wall && line.points_m.size() < 2) points.fail("a list of two points [x, y] or more");
  if (!wall && (line.points_m.size() != 2 || line.points_m[0] == line.points_m[1])) {
    points.fail("two points [x, y] that differ");
  }
  return line;
}

std::string points_text(const std::vector<Eigen::Vector2d>& points_m) {
  std::string text;
  for (const Eigen::Vector2d& point_m : points_m) {
    text += fmt::format("{}[{}, {}]", text.empty() ? "[" : ", ", point_m.x(), point_m.y());
  }
  return text + "]";
}

}  // namespace

const char* to_string(ZoneKind kind) {
  return kKindNames.at(static_cast<std::size_t>(kind));
}

std::optional<ZoneKind> zone_kind_of(std::string_view name) {
  for (std::size_t i = 0; i < kKindNames.size(); ++i) {
    if (name == kKindNames[i]) return static_cast<ZoneKind>(i);
  }
  return std::nullopt;
}

ZoneDrawing read_zone_drawing(const std::filesystem::path& path) {
  return parse_zone_drawing(read_yaml_file(path), path.string());
}

ZoneDrawing parse_zone_drawing(const std::string& text, const std::string& source) {
  const YamlNode root = support::parse_yaml(text, source, "the file");
  root.allow_keys({"zones", "places", "walls", "openings", "doors"});
  ZoneDrawing drawing;
  std::set<std::string> zone_names;
  for (const YamlNode& node : root.at("zones").items("a zone")) {
    node.allow_keys({"name", "polygon", "kind", "value"});
    const ZoneKind kind = kind_of(node.at("kind"));
    drawing.zones.push_back({new_name(node.at("name"), zone_names), polygon_of(node.at("polygon")),
                             kind, value_of(node.at("value"), kind)});
  }
  std::set<std::string> place_names;
  for (const YamlNode& node : root.at("places").items("a place")) {
    node.allow_keys({"name", "at", "heading"});
    Place& place = drawing.places.emplace_back();
    place.name = new_name(node.at("name"), place_names);
    place.position_m = drawn_point_of(node.at("at"));
    if (const YamlNode heading = node.at("heading"); heading.exists()) {
      place.station_heading_rad = heading.number(-std::numbers::pi, std::numbers::pi, "rad");
    }
  }
  std::set<std::string> line_names;
  for (std::size_t kind = 0; kind < kLineKinds; ++kind) {
    for (const YamlNode& node : root.at(kLineLists.at(kind)).items(kLineWords.at(kind))) {
      drawing.lines.push_back(line_of(node, static_cast<LineKind>(kind), line_names));
    }
  }
  return drawing;
}

std::string zone_drawing_text(const ZoneDrawing& drawing) {
  std::string zones;
  for (const DrawnZone& zone : drawing.zones) {
    zones += fmt::format("  - name: {}\n    kind: {}\n", support::yaml_scalar(zone.name),
                         to_string(zone.kind));
    const bool valued = zone.kind == ZoneKind::kSlow || zone.kind == ZoneKind::kOneWay;
    if (valued) zones += fmt::format("    value: {}\n", zone.value);
    zones += fmt::format("    polygon: {}\n", points_text(zone.polygon_m));
  }
  std::string places;
  for (const Place& place : drawing.places) {
    places += fmt::format("  - name: {}\n    at: [{}, {}]\n", support::yaml_scalar(place.name),
                          place.position_m.x(), place.position_m.y());
    if (place.station_heading_rad) {
      places += fmt::format("    heading: {}\n", *place.station_heading_rad);
    }
  }
  std::array<std::string, kLineKinds> lines;
  for (const DrawnLine& line : drawing.lines) {
    std::string& list = lines.at(static_cast<std::size_t>(line.kind));
    list += fmt::format("  - points: {}\n", points_text(line.points_m));
    if (!line.name.empty()) list += fmt::format("    name: {}\n", support::yaml_scalar(line.name));
  }
  std::string text;
  const auto add = [&](const char* list, const std::string& entries) {
    if (!entries.empty()) text += fmt::format("{}:\n{}", list, entries);
  };
  add("zones", zones);
  add("places", places);
  for (std::size_t kind = 0; kind < kLineKinds; ++kind) add(kLineLists.at(kind), lines.at(kind));
  return text.empty() ? "zones: []\n" : text;
}

}  // namespace topogeo::planning
