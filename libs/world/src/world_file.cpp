// The world file: YAML into segments and circles.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include <yaml-cpp/yaml.h>

#include "topogeo/world/world.hpp"

namespace topogeo::world {
namespace {

constexpr double kMaxCoordinate_m = 1e5;

struct Door {
  double begin_m;
  double end_m;
  bool leaf;          // shut but for some of the time
  ChangingPart open;  // when, without surfaces
};

class WorldParser {
 public:
  explicit WorldParser(const std::string& source) : source_(source) {}

  World parse(const YAML::Node& root) {
    expect_keys(root, "the world",
                {"name", "wall_thickness", "walls", "boxes", "columns", "segments", "tour",
                 "people", "places"});
    if (const YAML::Node name = root["name"]) world_.name = text(name, "name");
    double thickness_m = 0.0;
    if (const YAML::Node node = root["wall_thickness"]) {
      thickness_m = number(node, "wall_thickness", 0.0, 1.0);
    }
    for (const YAML::Node& node : list(root["walls"], "walls")) add_wall(node, thickness_m);
    for (const YAML::Node& node : list(root["boxes"], "boxes")) add_box(node);
    for (const YAML::Node& node : list(root["columns"], "columns")) add_column(node);
    for (const YAML::Node& node : list(root["segments"], "segments")) {
      const auto v = numbers(node, "segments", 4);
      add_segment(node, "segments", {v[0], v[1]}, {v[2], v[3]});
    }
    for (const YAML::Node& node : list(root["tour"], "tour")) {
      world_.tour_m.push_back(point(node, "tour"));
    }
    for (const YAML::Node& node : list(root["people"], "people")) add_person(node);
    for (const YAML::Node& node : list(root["places"], "places")) add_place(node);
    if (world_.segments.empty() && world_.circles.empty() && world_.changing.empty()) {
      fail(root, "the world", "walls, boxes, columns or segments", "none");
    }
    return std::move(world_);
  }

 private:
  [[noreturn]] void fail(const YAML::Node& node, std::string_view key, const std::string& expected,
                         const std::string& got) const {
    const int line = node.IsDefined() ? node.Mark().line + 1 : 1;
    throw std::runtime_error(source_ + ":" + std::to_string(std::max(line, 1)) + ": " +
                             std::string(key) + ": expected " + expected + ", got " + got);
  }

  static std::string shown(const YAML::Node& node) {
    if (!node.IsDefined()) return "nothing";
    if (node.IsScalar()) return std::string("'").append(node.Scalar()).append("'");
    if (node.IsSequence()) return "a list of " + std::to_string(node.size());
    return node.IsMap() ? "a map" : "nothing";
  }

  void expect_keys(const YAML::Node& node, std::string_view what,
                   std::initializer_list<std::string_view> allowed) const {
    if (!node.IsMap()) fail(node, what, "a map of keys and values", shown(node));
    for (const auto& entry : node) {
      const YAML::Node& key = entry.first;
      if (key.IsScalar() &&
          std::find(allowed.begin(), allowed.end(), key.Scalar()) != allowed.end()) {
        continue;
      }
      std::string names;
      for (const std::string_view name : allowed) {
        if (!names.empty()) names.append(", ");
        names.append(name);
      }
      fail(key, what, "one of the keys " + names, shown(key));
    }
  }

  std::string text(const YAML::Node& node, std::string_view key) const {
    if (!node.IsScalar()) fail(node, key, "a text", shown(node));
    return node.Scalar();
  }

  double number(const YAML::Node& node, std::string_view key, double low, double high,
                const char* unit = "m") const {
    double value = 0.0;
    const bool is_number =
        node.IsDefined() && node.IsScalar() && YAML::convert<double>::decode(node, value);
    if (!is_number || !(value >= low && value <= high)) {
      std::ostringstream range;
      range << "a number in [" << low << ", " << high << "] " << unit;
      fail(node, key, range.str(), shown(node));
    }
    return value;
  }

  // A key that is absent is an empty list.
  YAML::Node list(const YAML::Node& node, std::string_view key) const {
    if (!node.IsDefined()) return YAML::Node(YAML::NodeType::Sequence);
    if (!node.IsSequence()) fail(node, key, "a list", shown(node));
    return node;
  }

  std::vector<double> numbers(const YAML::Node& node, std::string_view key, std::size_t n) const {
    if (!node.IsDefined() || !node.IsSequence() || node.size() != n) {
      fail(node, key, std::to_string(n) + " coordinates in brackets", shown(node));
    }
    std::vector<double> values;
    for (const YAML::Node& value : node) {
      values.push_back(number(value, key, -kMaxCoordinate_m, kMaxCoordinate_m));
    }
    return values;
  }

  Eigen::Vector2d point(const YAML::Node& node, std::string_view key) const {
    const auto v = numbers(node, key, 2);
    return {v[0], v[1]};
  }

  // A value that must be there; its absence is reported at the line of the parent.
  YAML::Node required(const YAML::Node& parent, const std::string& key) const {
    const YAML::Node node = parent[key];
    if (!node.IsDefined()) fail(parent, key, "a value", "nothing");
    return node;
  }

  void add_segment(const YAML::Node& node, std::string_view key, const Eigen::Vector2d& a_m,
                   const Eigen::Vector2d& b_m) {
    if (!((b_m - a_m).norm() > 0.0)) fail(node, key, "two different points", "the same twice");
    world_.segments.push_back({a_m, b_m});
  }

  static void add_loop(std::initializer_list<Eigen::Vector2d> corners_m,
                       std::vector<Segment>& segments) {
    const Eigen::Vector2d* previous = corners_m.end() - 1;
    for (const Eigen::Vector2d& corner : corners_m) {
      segments.push_back({*previous, corner});
      previous = &corner;
    }
  }

  // Calls `add` with the ends of each part.
  template <typename Add>
  void for_intervals(const YAML::Node& node, std::string_view key, const char* unit,
                     const Add& add) const {
    for (const YAML::Node& part : list(node, key)) {
      if (!part.IsSequence() || part.size() != 2) {
        fail(part, key, "parts of the way or the time as [from, to]", shown(part));
      }
      const double from = number(part[0], key, 0.0, kMaxCoordinate_m, unit);
      const double to = number(part[1], key, 0.0, kMaxCoordinate_m, unit);
      if (!(from < to)) fail(part, key, "[from, to] with from < to", "from >= to");
      add(from, to);
    }
  }

  // When something is there or open; nothing when that does not change. `word` is "present" or
  // "open".
  std::optional<ChangingPart> changes(const YAML::Node& node, const std::string& word) const {
    ChangingPart part;
    const YAML::Node way = node[word];
    const YAML::Node time = node[word + "_s"];
    const YAML::Node random = node["random"];
    if (!way && !time && !random) return std::nullopt;
    for_intervals(way, word, "m", [&](double from_m, double to_m) {
      part.present.push_back({from_m, to_m});
    });
    for_intervals(time, word + "_s", "s", [&](double from_s, double to_s) {
      part.present_s.push_back({from_s, to_s});
    });
    if (random) {
      if (!random.IsSequence() || random.size() != 2) {
        fail(random, "random", "two mean times as [" + word + ", not]", shown(random));
      }
      constexpr double kShortest_s = 0.1;
      part.random = RandomTurns{number(random[0], "random", kShortest_s, kMaxCoordinate_m, "s"),
                                number(random[1], "random", kShortest_s, kMaxCoordinate_m, "s")};
    }
    return part;
  }

  void add_person(const YAML::Node& node) {
    expect_keys(node, "people", {"path", "speed", "radius", "start", "yields"});
    Person person;
    for (const YAML::Node& place : list(required(node, "path"), "path")) {
      person.path_m.push_back(point(place, "path"));
    }
    if (person.path_m.empty()) fail(node, "path", "a point or more", "none");
    if (node["speed"]) person.speed_m_per_s = number(node["speed"], "speed", 0.0, 10.0, "m/s");
    if (node["radius"]) person.radius_m = number(node["radius"], "radius", 0.01, 2.0);
    if (node["start"]) person.start_s = number(node["start"], "start", 0.0, 1e6, "s");
    if (const YAML::Node yields = node["yields"]) {
      if (!yields.IsScalar() || !YAML::convert<bool>::decode(yields, person.yields)) {
        fail(yields, "yields", "true or false", shown(yields));
      }
    }
    world_.people.push_back(std::move(person));
  }

  void add_place(const YAML::Node& node) {
    expect_keys(node, "places", {"name", "at"});
    const std::string name = text(required(node, "name"), "name");
    const auto is_it = [&](const NamedPlace& place) { return place.name == name; };
    if (name.empty() || std::ranges::any_of(world_.places, is_it)) {
      fail(node, "name", "a name that is not empty, each once", "'" + name + "'");
    }
    world_.places.push_back({name, point(required(node, "at"), "at")});
  }

  void add_box(const YAML::Node& node) {
    expect_keys(node, "boxes", {"from", "to", "present", "present_s", "random"});
    const Eigen::Vector2d a_m = point(required(node, "from"), "from");
    const Eigen::Vector2d b_m = point(required(node, "to"), "to");
    if (a_m.x() == b_m.x() || a_m.y() == b_m.y()) {
      fail(node, "boxes", "two corners that differ in x and y", "a box without area");
    }
    std::optional<ChangingPart> part = changes(node, "present");
    add_loop({a_m, {b_m.x(), a_m.y()}, b_m, {a_m.x(), b_m.y()}},
             part ? part->segments : world_.segments);
    if (part) world_.changing.push_back(std::move(*part));
  }

  void add_column(const YAML::Node& node) {
    expect_keys(node, "columns", {"center", "radius", "present", "present_s", "random"});
    const Eigen::Vector2d center_m = point(required(node, "center"), "center");
    const Circle circle{center_m, number(required(node, "radius"), "radius", 0.01, 100.0)};
    if (std::optional<ChangingPart> part = changes(node, "present")) {
      part->circles.push_back(circle);
      world_.changing.push_back(std::move(*part));
    } else {
      world_.circles.push_back(circle);
    }
  }

  std::vector<Door> doors_of(const YAML::Node& wall, double length_m) const {
    std::vector<Door> doors;
    for (const YAML::Node& node : list(wall["doors"], "doors")) {
      expect_keys(node, "doors", {"at", "width", "open", "open_s", "random"});
      const double at_m = number(required(node, "at"), "at", 0.0, length_m);
      const double width_m = number(required(node, "width"), "width", 0.01, length_m);
      const std::optional<ChangingPart> open = changes(node, "open");
      const Door door{at_m - width_m / 2.0, at_m + width_m / 2.0, open.has_value(),
                      open.value_or(ChangingPart{})};
      const auto overlaps = [&](const Door& d) {
        return door.begin_m < d.end_m && d.begin_m < door.end_m;
      };
      if (door.begin_m < 0.0 || door.end_m > length_m ||
          std::any_of(doors.begin(), doors.end(), overlaps)) {
        std::ostringstream expected;
        expected << "a door inside its wall of " << length_m << " m and clear of the others";
        std::ostringstream got;
        got << "one from " << door.begin_m << " to " << door.end_m << " m";
        fail(node, "doors", expected.str(), got.str());
      }
      doors.push_back(door);
    }
    std::sort(doors.begin(), doors.end(),
              [](const Door& a, const Door& b) { return a.begin_m < b.begin_m; });
    return doors;
  }

  void add_wall(const YAML::Node& node, double thickness_m) {
    expect_keys(node, "walls", {"from", "to", "doors"});
    const Eigen::Vector2d from_m = point(required(node, "from"), "from");
    const Eigen::Vector2d to_m = point(required(node, "to"), "to");
    const double length_m = (to_m - from_m).norm();
    if (!(length_m > 0.0)) fail(node, "walls", "two different points", "the same twice");
    const Eigen::Vector2d along = (to_m - from_m) / length_m;
    const Eigen::Vector2d half = Eigen::Vector2d(-along.y(), along.x()) * (thickness_m / 2.0);
    const auto add_piece = [&](double begin_m, double end_m) {
      if (!(end_m > begin_m)) return;
      const Eigen::Vector2d a_m = from_m + begin_m * along;
      const Eigen::Vector2d b_m = from_m + end_m * along;
      if (thickness_m > 0.0) {
        add_loop({a_m - half, b_m - half, b_m + half, a_m + half}, world_.segments);
      } else {
        world_.segments.push_back({a_m, b_m});
      }
    };
    double begin_m = 0.0;
    for (const Door& door : doors_of(node, length_m)) {
      add_piece(begin_m, door.begin_m);
      begin_m = door.end_m;
      if (!door.leaf) continue;
      ChangingPart part = door.open;
      part.segments.push_back({from_m + door.begin_m * along, from_m + door.end_m * along});
      part.otherwise = true;
      world_.changing.push_back(std::move(part));
    }
    add_piece(begin_m, length_m);
  }

  const std::string& source_;
  World world_;
};

}  // namespace

World parse_world(const std::string& text, const std::string& source) {
  try {
    return WorldParser(source).parse(YAML::Load(text));
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(source + ":" + std::to_string(std::max(error.mark.line + 1, 1)) +
                             ": expected YAML, got: " + error.msg);
  }
}

World load_world(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw std::runtime_error(path.string() + ": expected a world file, got " +
                             (std::filesystem::exists(path, error) ? "something else" : "nothing"));
  }
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw std::runtime_error(path.string() + ": cannot read the world file");
  return parse_world(text.str(), path.string());
}

}  // namespace topogeo::world
