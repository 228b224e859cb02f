// The YAML file of drawn zones and named places.
#include <set>
#include <vector>

#include "topogeo/planning/zones.hpp"
#include "topogeo/support/yaml_reader.hpp"

#include "text_file.hpp"

namespace topogeo::planning {
namespace {

using support::YamlNode;

constexpr double kMaxDrawn_m = 1e6;  // as a grid, see occupancy_grid.cpp

std::string new_name(const YamlNode& node, std::set<std::string>& taken) {
  std::string name = node.text();
  if (name.empty()) node.fail("a text that is not empty");
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

}  // namespace

ZoneDrawing read_zone_drawing(const std::filesystem::path& path) {
  return parse_zone_drawing(read_text_file(path), path.string());
}

ZoneDrawing parse_zone_drawing(const std::string& text, const std::string& source) {
  const YamlNode root = support::parse_yaml(text, source, "the file");
  root.allow_keys({"zones", "places"});
  ZoneDrawing drawing;
  std::set<std::string> zone_names;
  for (const YamlNode& node : root.at("zones").items("a zone")) {
    node.allow_keys({"name", "polygon"});
    drawing.zones.push_back(
        {new_name(node.at("name"), zone_names), polygon_of(node.at("polygon"))});
  }
  std::set<std::string> place_names;
  for (const YamlNode& node : root.at("places").items("a place")) {
    node.allow_keys({"name", "at"});
    drawing.places.push_back(
        {new_name(node.at("name"), place_names), drawn_point_of(node.at("at"))});
  }
  return drawing;
}

}  // namespace topogeo::planning
