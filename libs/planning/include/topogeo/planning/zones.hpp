// Zones: parts of the free space that meet at borders (MACONDO, III.2; docs/algorithms.md, "Hybrid
// map and planner"). They are drawn, are the rooms found between the walls, or follow from the
// width of the free space alone.
//
// In any case every passable cell is in exactly one zone, and a zone is connected: a robot gets
// from each of its cells to every other one without leaving it.
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
inline constexpr ZoneId kNoZone = 0xffff;  ///< of a cell without a zone

struct Zone {
  ZoneId id = 0;     ///< index in ZoneMap::zones
  std::string name;  ///< "" if it was neither drawn nor named by RoomNumbers
  std::size_t cells = 0;
  CellBox box;             ///< the smallest one around its cells
  std::uint32_t room = 0;  ///< persistent number of the room (RoomNumbers); 0: not numbered
};

struct ZoneMap {
  std::vector<ZoneId> zone_of_cell;  ///< row by row; kNoZone for impassable cells
  std::vector<Zone> zones;
};

/// A place of least clearance, with the direction of the path through it.
struct Passage {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< map frame
  Eigen::Vector2d along = Eigen::Vector2d::UnitX();      ///< unit vector
  double clearance_m = 0.0;
};

/// The doors and narrowings of a topo-geometric map, in the order of their nodes, except those
/// without a branch that was seen.
std::vector<Passage> passages_of(const topomap::GlobalMap& map);

/// Rooms, corridors and halls: basins of clearance between the walls, ignoring furniture, merged
/// unless the place between them is a door or the mouth of a corridor. At a passage of the map a
/// smaller narrowing suffices. After Bormann et al., "Room segmentation: survey, implementation,
/// and analysis", ICRA 2016, distance transform and Voronoi methods; they split the floor by areas
/// and lengths, here the widths on either side decide. Drawn doors of the space always split it.
ZoneMap zones_of_rooms(const FreeSpace& space, std::span<const Passage> passages = {},
                       const ZoneConfig& config = {});

/// Zones for maps without a graph: the wide parts of the free space, each with the nearer half of
/// the narrow passages.
ZoneMap zones_by_width(const FreeSpace& space, const ZoneConfig& config = {});

/// Name in files: "room", "no_go", "slow", "one_way".
const char* to_string(ZoneKind kind);
/// Empty for an unknown kind.
std::optional<ZoneKind> zone_kind_of(std::string_view name);

/// A zone for each polygon; if walls separate it into parts, the largest has the name and the
/// others are "NAME 2", "NAME 3", ... The free space outside of all polygons becomes zones without
/// a name, split at the drawn doors of the space.
ZoneMap drawn_zones(const FreeSpace& space, std::span<const DrawnZone> drawn,
                    const ZoneConfig& config = {});

/// A named place.
struct Place {
  std::string name;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< map frame
  /// Heading of a robot at a base station, which is put there to be located (MACONDO, III.3), (-pi,
  /// pi], map frame. Other places have none.
  std::optional<double> station_heading_rad = std::nullopt;

  friend bool operator==(const Place&, const Place&) = default;
};

/// Transforms a place by T, from its own frame to another; a heading turns with it.
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
///   walls:                                  # names of walls and openings are optional
///     - {points: [[0, 0], [4, 0], [4, 3]]}
///   openings:
///     - {points: [[1, 0], [2, 0]]}
///   doors:
///     - {name: front door, points: [[4, 1], [4, 2]]}
/// Throws std::runtime_error naming file, line and expectation: an unreadable file, broken YAML, an
/// unknown key or kind, an empty or repeated name, a polygon of fewer than three corners, a wall of
/// fewer than two points, an opening or door with other than two, a coordinate or value out of
/// range.
ZoneDrawing read_zone_drawing(const std::filesystem::path& path);

/// The same from text; messages name `source` as the file.
ZoneDrawing parse_zone_drawing(const std::string& text, const std::string& source);

/// The text of such a file, with exact numbers; empty lists are left out, unless all are empty.
std::string zone_drawing_text(const ZoneDrawing& drawing);

}  // namespace topogeo::planning
