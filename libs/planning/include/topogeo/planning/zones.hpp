// Zones: parts of the free space that meet at borders (MACONDO, III.2; docs/algorithms.md, "Hybrid
// map and planner"). They are drawn, the rooms that
// are found between the walls, or found from the width of the free space alone.
//
// However they come about, every passable cell is in exactly one zone, and a zone hangs together:
// a robot gets from each of its cells to each other without leaving it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/planning/drawn_line.hpp"
#include "topogeo/planning/drawn_zone.hpp"
#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/grid_config.hpp"
#include "topogeo/planning/grid_search.hpp"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::planning {

using ZoneId = std::uint16_t;
inline constexpr ZoneId kNoZone = 0xffff;  ///< of a cell that is in none

struct Zone {
  ZoneId id = 0;     ///< index in ZoneMap::zones
  std::string name;  ///< "" when it was not drawn and RoomNumbers has not named it
  std::size_t cells = 0;
  CellBox box;             ///< the smallest one around its cells
  std::uint32_t room = 0;  ///< stays with the room from map to map (RoomNumbers); 0: not numbered
};

struct ZoneMap {
  std::vector<ZoneId> zone_of_cell;  ///< row by row; kNoZone for cells that are not passable
  std::vector<Zone> zones;
};

/// A place of least clearance, with the direction of the path through it.
struct Passage {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< map frame
  Eigen::Vector2d along = Eigen::Vector2d::UnitX();      ///< unit vector
  double clearance_m = 0.0;
};

/// The doors and narrowings of a topo-geometric map, in the order of their nodes. Those without a
/// branch that was seen are left out.
std::vector<Passage> passages_of(const topomap::GlobalMap& map);

/// Rooms, corridors and halls: basins of clearance between the walls (what stands free on the floor
/// parts nothing), joined where the place between them is no door and no mouth of a corridor. At a
/// passage of the map less of a narrowing is enough. After Bormann et al., "Room segmentation:
/// survey, implementation, and analysis", ICRA 2016, distance transform and Voronoi methods; they
/// part the floor by areas and lengths, here the widths on either side decide. Drawn doors of the
/// space part it in any case.
ZoneMap zones_of_rooms(const FreeSpace& space, std::span<const Passage> passages = {},
                       const ZoneConfig& config = {});

/// Zones for maps without a graph: the wide parts of the free space, each with the half of the
/// narrow passages that is nearer to it.
ZoneMap zones_by_width(const FreeSpace& space, const ZoneConfig& config = {});

/// As files name them: "room", "no_go", "slow", "one_way".
const char* to_string(ZoneKind kind);
/// Empty when there is no such kind.
std::optional<ZoneKind> zone_kind_of(std::string_view name);

/// A zone for each polygon; when walls separate it into parts, the largest has the name and the
/// others are "NAME 2", "NAME 3", ... The free space outside of all polygons becomes zones without
/// a name, parted at the drawn doors of the space.
ZoneMap drawn_zones(const FreeSpace& space, std::span<const DrawnZone> drawn,
                    const ZoneConfig& config = {});

/// A place that has a name.
struct Place {
  std::string name;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< map frame
  /// Of a base station, on which a robot is put to be found (MACONDO, III.3): the heading of who
  /// stands there, (-pi, pi], map frame. Other places have none.
  std::optional<double> station_heading_rad = std::nullopt;

  friend bool operator==(const Place&, const Place&) = default;
};

/// The same place in a frame in which its own has the pose T; a heading turns with it.
Place moved(const Place& place, const geometry::Pose2& T);

struct ZoneDrawing {
  std::vector<DrawnZone> zones;
  std::vector<Place> places;
  std::vector<DrawnLine> lines;
};

/// Reads zones and places:
///   zones:
///     - {name: hall, polygon: [[0, 0], [4, 0], [4, 3], [0, 3]]}
///     - {name: ramp, kind: slow, value: 0.3, polygon: [[4, 0], [6, 0], [6, 1]]}
///   places:
///     - {name: room A, at: [1.5, 2.0]}
///     - {name: base station, at: [0.5, 0.5], heading: 1.57}
///   walls:                                  # names of walls and openings may be left out
///     - {points: [[0, 0], [4, 0], [4, 3]]}
///   openings:
///     - {points: [[1, 0], [2, 0]]}
///   doors:
///     - {name: front door, points: [[4, 1], [4, 2]]}
/// Throws std::runtime_error naming file, line and what was expected: an unreadable file, broken
/// YAML, an unknown key or kind, an empty or repeated name, a polygon of less than three corners, a
/// wall of less than two points, an opening or door of other than two, a coordinate or value out of
/// range.
ZoneDrawing read_zone_drawing(const std::filesystem::path& path);

/// The same from text; `source` stands for the file in messages.
ZoneDrawing parse_zone_drawing(const std::string& text, const std::string& source);

/// Such a file, to the last digit; lists that are empty are left out, unless all are.
std::string zone_drawing_text(const ZoneDrawing& drawing);

}  // namespace topogeo::planning
