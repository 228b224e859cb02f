// The world file: converts YAML to segments and circles.
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "topogeo/support/foreign_file.hpp"
#include "topogeo/support/yaml_reader.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::world {
namespace {

using support::YamlNode;

/// 100 km, beyond any building: a larger coordinate, distance or time is a mistake.
constexpr double kLargest = 1e5;
/// Walls are lines or up to 1 m thick.
constexpr double kThickestWall_m = 1.0;
/// Thinner columns and narrower doors fall between the beams of any laser.
constexpr double kSmallest_m = 0.01;
constexpr double kLargestColumn_m = 100.0;
/// A sprinter's speed.
constexpr double kFastestPerson_m_s = 10.0;
constexpr double kWidestPerson_m = 2.0;
/// Over eleven days, longer than any drive.
constexpr double kLatestStart_s = 1e6;
/// Bounds the number of draws; about the scan period of a slow laser.
constexpr double kShortestTurn_s = 0.1;
/// Far more entries than people draw: names, doors and lines are compared in pairs or drawn on a
/// grid.
constexpr std::size_t kMostEntries = 20'000;  // in a list
constexpr std::size_t kMostDoors = 1'000;     // in a wall
constexpr std::size_t kMostSegments = 100'000;

struct Door {
  double begin_m;
  double end_m;
  bool leaf;          // shut except at certain times or distances
  ChangingPart open;  // when it is open, without surfaces
};

Eigen::Vector2d point_of(const YamlNode& node) {
  const std::vector<YamlNode> items = node.tuple(2, "2 coordinates in brackets");
  return {items[0].number(-kLargest, kLargest, "m"), items[1].number(-kLargest, kLargest, "m")};
}

double number_or(const YamlNode& node, double low, double high, const char* unit, double absent) {
  return node.exists() ? node.number(low, high, unit) : absent;
}

// Calls `add` with the ends of each interval.
template <typename Add>
void for_intervals(const YamlNode& node, const char* unit, const Add& add) {
  for (const YamlNode& interval : node.items()) {
    const auto ends = interval.tuple(2, "intervals of the distance or the time as [from, to]");
    const double from = ends[0].number(0.0, kLargest, unit);
    const double to = ends[1].number(0.0, kLargest, unit);
    if (!(from < to)) interval.fail("[from, to] with from < to", "from >= to");
    add(from, to);
  }
}

// The times when a part is present or open; nothing if it does not change. `word` is "present" or
// "open".
std::optional<ChangingPart> changes_of(const YamlNode& node, const std::string& word) {
  ChangingPart part;
  const YamlNode distances = node.at(word);
  const YamlNode times = node.at(word + "_s");
  const YamlNode random = node.at("random");
  if (!distances.exists() && !times.exists() && !random.exists()) return std::nullopt;
  for_intervals(distances, "m", [&](double from_m, double to_m) {
    part.present.push_back({from_m, to_m});
  });
  for_intervals(times, "s", [&](double from_s, double to_s) {
    part.present_s.push_back({from_s, to_s});
  });
  if (random.exists()) {
    const auto means = random.tuple(2, "two mean times as [" + word + ", not]");
    part.random = RandomTurns{means[0].number(kShortestTurn_s, kLargest, "s"),
                              means[1].number(kShortestTurn_s, kLargest, "s")};
  }
  return part;
}

void add_loop(std::initializer_list<Eigen::Vector2d> corners_m, std::vector<Segment>& segments) {
  const Eigen::Vector2d* previous = corners_m.end() - 1;
  for (const Eigen::Vector2d& corner : corners_m) {
    segments.push_back({*previous, corner});
    previous = &corner;
  }
}

/// The items of a list of limited length; empty if the map has no such list.
std::vector<YamlNode> entries_of(const YamlNode& map, const std::string& key,
                                 std::size_t most = kMostEntries) {
  std::vector<YamlNode> items = map.at(key).items();
  if (items.size() > most) {
    map.at(key).fail("at most " + std::to_string(most) + " entries", std::to_string(items.size()));
  }
  return items;
}

std::vector<Door> doors_of(const YamlNode& wall, double length_m) {
  std::vector<Door> doors;
  for (const YamlNode& node : entries_of(wall, "doors", kMostDoors)) {
    node.allow_keys({"at", "width", "open", "open_s", "random"});
    const double at_m = node.required("at").number(0.0, length_m, "m");
    const double width_m = node.required("width").number(kSmallest_m, length_m, "m");
    const std::optional<ChangingPart> open = changes_of(node, "open");
    const Door door{at_m - width_m / 2.0, at_m + width_m / 2.0, open.has_value(),
                    open.value_or(ChangingPart{})};
    const auto overlaps = [&](const Door& d) {
      return door.begin_m < d.end_m && d.begin_m < door.end_m;
    };
    if (door.begin_m < 0.0 || door.end_m > length_m || std::ranges::any_of(doors, overlaps)) {
      std::ostringstream expected;
      expected << "a door inside its wall of " << length_m << " m and clear of the others";
      std::ostringstream got;
      got << "one from " << door.begin_m << " to " << door.end_m << " m";
      node.fail(expected.str(), got.str());
    }
    doors.push_back(door);
  }
  std::sort(doors.begin(), doors.end(),
            [](const Door& a, const Door& b) { return a.begin_m < b.begin_m; });
  return doors;
}

class WorldParser {
 public:
  World parse(const YamlNode& root) {
    root.allow_keys({"name", "wall_thickness", "walls", "boxes", "columns", "segments", "tour",
                     "people", "places", "rooms"});
    if (const YamlNode name = root.at("name"); name.exists()) world_.name = name.text();
    const double thickness_m = number_or(root.at("wall_thickness"), 0.0, kThickestWall_m, "m", 0.0);
    for (const YamlNode& node : entries_of(root, "walls")) add_wall(node, thickness_m);
    for (const YamlNode& node : entries_of(root, "boxes")) add_box(node);
    for (const YamlNode& node : entries_of(root, "columns")) add_column(node);
    for (const YamlNode& node : entries_of(root, "segments")) add_segment(node);
    for (const YamlNode& node : entries_of(root, "tour")) world_.tour_m.push_back(point_of(node));
    for (const YamlNode& node : entries_of(root, "people")) add_person(node);
    for (const YamlNode& node : entries_of(root, "places")) add_place(node);
    for (const YamlNode& node : entries_of(root, "rooms")) add_room(node);
    if (world_.segments.size() > kMostSegments) {
      root.fail("walls and boxes of at most " + std::to_string(kMostSegments) + " lines",
                std::to_string(world_.segments.size()));
    }
    if (world_.segments.empty() && world_.circles.empty() && world_.changing.empty()) {
      root.fail("walls, boxes, columns or segments", "none");
    }
    return std::move(world_);
  }

 private:
  void add_segment(const YamlNode& node) {
    std::vector<double> v;
    for (const YamlNode& item : node.tuple(4, "4 coordinates in brackets")) {
      v.push_back(item.number(-kLargest, kLargest, "m"));
    }
    const Segment segment{{v[0], v[1]}, {v[2], v[3]}};
    if (!((segment.b_m - segment.a_m).norm() > 0.0)) {
      node.fail("two different points", "the same twice");
    }
    world_.segments.push_back(segment);
  }

  void add_person(const YamlNode& node) {
    node.allow_keys({"path", "speed", "radius", "start", "yields"});
    Person person;
    for (const YamlNode& place : node.required("path").items()) {
      person.path_m.push_back(point_of(place));
    }
    if (person.path_m.empty()) node.at("path").fail("a point or more", "none");
    person.speed_m_per_s =
        number_or(node.at("speed"), 0.0, kFastestPerson_m_s, "m/s", person.speed_m_per_s);
    person.radius_m =
        number_or(node.at("radius"), kSmallest_m, kWidestPerson_m, "m", person.radius_m);
    person.start_s = number_or(node.at("start"), 0.0, kLatestStart_s, "s", person.start_s);
    if (const YamlNode yields = node.at("yields"); yields.exists()) {
      person.yields = yields.boolean();
    }
    world_.people.push_back(std::move(person));
  }

  void add_place(const YamlNode& node) {
    node.allow_keys({"name", "at", "heading"});
    const std::string name = node.required("name").text();
    const auto has_name = [&](const NamedPlace& place) { return place.name == name; };
    if (name.empty() || std::ranges::any_of(world_.places, has_name)) {
      node.at("name").fail("a non-empty name that is not taken");
    }
    NamedPlace place{name, point_of(node.required("at"))};
    if (const YamlNode heading = node.at("heading"); heading.exists()) {
      place.station_heading_rad = heading.number(-std::numbers::pi, std::numbers::pi, "rad");
    }
    world_.places.push_back(std::move(place));
  }

  void add_room(const YamlNode& node) {
    node.allow_keys({"name", "polygon"});
    Room room{node.required("name").text(), {}};
    const auto has_name = [&](const Room& other) { return other.name == room.name; };
    if (room.name.empty() || std::ranges::any_of(world_.rooms, has_name)) {
      node.at("name").fail("a non-empty name that is not taken");
    }
    for (const YamlNode& corner : node.required("polygon").items()) {
      room.polygon_m.push_back(point_of(corner));
    }
    constexpr std::size_t kLeastCorners = 3;
    if (room.polygon_m.size() < kLeastCorners) node.at("polygon").fail("three corners or more");
    world_.rooms.push_back(std::move(room));
  }

  void add_box(const YamlNode& node) {
    node.allow_keys({"from", "to", "present", "present_s", "random"});
    const Eigen::Vector2d a_m = point_of(node.required("from"));
    const Eigen::Vector2d b_m = point_of(node.required("to"));
    if (a_m.x() == b_m.x() || a_m.y() == b_m.y()) {
      node.fail("two corners that differ in x and y", "a box without area");
    }
    std::optional<ChangingPart> part = changes_of(node, "present");
    add_loop({a_m, {b_m.x(), a_m.y()}, b_m, {a_m.x(), b_m.y()}},
             part ? part->segments : world_.segments);
    if (part) world_.changing.push_back(std::move(*part));
  }

  void add_column(const YamlNode& node) {
    node.allow_keys({"center", "radius", "present", "present_s", "random"});
    const Circle circle{point_of(node.required("center")),
                        node.required("radius").number(kSmallest_m, kLargestColumn_m, "m")};
    if (std::optional<ChangingPart> part = changes_of(node, "present")) {
      part->circles.push_back(circle);
      world_.changing.push_back(std::move(*part));
    } else {
      world_.circles.push_back(circle);
    }
  }

  void add_wall(const YamlNode& node, double thickness_m) {
    node.allow_keys({"from", "to", "doors"});
    const Eigen::Vector2d from_m = point_of(node.required("from"));
    const Eigen::Vector2d to_m = point_of(node.required("to"));
    const double length_m = (to_m - from_m).norm();
    if (!(length_m > 0.0)) node.fail("two different points", "the same twice");
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

  World world_;
};

}  // namespace

World parse_world(const std::string& text, const std::string& source) {
  return WorldParser().parse(support::parse_yaml(text, source, "the world"));
}

World load_world(const std::filesystem::path& path) {
  return parse_world(support::foreign_content(path, support::kMostYamlBytes), path.string());
}

}  // namespace topogeo::world
