// The YAML file of drawn zones and named places.
#include <algorithm>
#include <set>
#include <stdexcept>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "topogeo/planning/zones.hpp"

#include "text_file.hpp"

namespace topogeo::planning {
namespace {

constexpr double kMaxDrawn_m = 1e6;  // as a grid, see occupancy_grid.cpp

class DrawingReader {
 public:
  explicit DrawingReader(const std::string& source) : source_(source) {}

  ZoneDrawing read(const YAML::Node& root) {
    ZoneDrawing drawing;
    check_keys(root, "the file", {"zones", "places"});
    std::set<std::string> zone_names;
    for (const YAML::Node& node : list(root["zones"], "zones")) {
      check_keys(node, "a zone", {"name", "polygon"});
      drawing.zones.push_back({name(node["name"], zone_names), polygon(node["polygon"])});
    }
    std::set<std::string> place_names;
    for (const YAML::Node& node : list(root["places"], "places")) {
      check_keys(node, "a place", {"name", "at"});
      drawing.places.push_back({name(node["name"], place_names), point(node["at"], "at")});
    }
    return drawing;
  }

 private:
  void check_keys(const YAML::Node& node, const std::string& what,
                  const std::vector<std::string>& known) const {
    const std::string expected = "a map with the keys " + known[0] + " and " + known[1];
    if (!node.IsMap()) fail_in_yaml(source_, node, what, expected);
    for (const auto& entry : node) {
      const YAML::Node& key = entry.first;
      if (!key.IsScalar() || std::find(known.begin(), known.end(), key.Scalar()) == known.end()) {
        fail_in_yaml(source_, key, what, expected);
      }
    }
  }

  [[nodiscard]] YAML::Node list(const YAML::Node& node, const std::string& field) const {
    if (!node.IsDefined()) return YAML::Node(YAML::NodeType::Sequence);
    if (!node.IsSequence()) fail_in_yaml(source_, node, field, "a list");
    return node;
  }

  [[nodiscard]] std::string name(const YAML::Node& node, std::set<std::string>& taken) const {
    if (!node.IsDefined() || !node.IsScalar() || node.Scalar().empty()) {
      fail_in_yaml(source_, node, "name", "a text");
    }
    if (!taken.insert(node.Scalar()).second) {
      fail_in_yaml(source_, node, "name", "each name once");
    }
    return node.Scalar();
  }

  [[nodiscard]] Eigen::Vector2d point(const YAML::Node& node, const std::string& field) const {
    if (!node.IsDefined() || !node.IsSequence() || node.size() != 2) {
      fail_in_yaml(source_, node, field, "[x, y]");
    }
    return {number_in_yaml(source_, node[0], field, -kMaxDrawn_m, kMaxDrawn_m, "m"),
            number_in_yaml(source_, node[1], field, -kMaxDrawn_m, kMaxDrawn_m, "m")};
  }

  [[nodiscard]] std::vector<Eigen::Vector2d> polygon(const YAML::Node& node) const {
    constexpr std::size_t kLeastCorners = 3;
    if (!node.IsDefined() || !node.IsSequence() || node.size() < kLeastCorners) {
      fail_in_yaml(source_, node, "polygon", "a list of three corners [x, y] or more");
    }
    std::vector<Eigen::Vector2d> corners;
    for (const YAML::Node& corner : node) corners.push_back(point(corner, "polygon"));
    return corners;
  }

  const std::string& source_;
};

}  // namespace

ZoneDrawing read_zone_drawing(const std::filesystem::path& path) {
  return parse_zone_drawing(read_text_file(path), path.string());
}

ZoneDrawing parse_zone_drawing(const std::string& text, const std::string& source) {
  return DrawingReader(source).read(parse_yaml(text, source));
}

}  // namespace topogeo::planning
