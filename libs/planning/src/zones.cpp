#include "topogeo/planning/zones.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "topogeo/planning/drawn_and_found_rooms.hpp"

#include "clearance_basins.hpp"
#include "furniture.hpp"
#include "line_cells.hpp"
#include "polygon_cells.hpp"
#include "room_merger.hpp"
#include "zone_labels.hpp"

namespace topogeo::planning {
namespace {

using topomap::BranchPoint;
using topomap::GlobalMap;
using topomap::MapBranch;
using topomap::NodeKind;

// Directions are measured over this distance from a node, because the first points of a branch
// jitter.
constexpr double kTangentReach_m = 0.4;  // a branch bends by less than its noise on a shorter piece

// The first point at least kTangentReach_m from the first one, or the last point.
Eigen::Vector2d point_ahead(std::span<const BranchPoint> points, bool from_back) {
  const auto at = [&](std::size_t i) {
    return points[from_back ? points.size() - 1 - i : i].position_m;
  };
  for (std::size_t i = 1; i < points.size(); ++i) {
    if ((at(i) - at(0)).norm() >= kTangentReach_m) return at(i);
  }
  return at(points.size() - 1);
}

// Whether each saddle lies at a door or narrowing of the map.
std::vector<bool> saddles_at_doors(const GridFrame& frame, const Basins& basins,
                                   std::span<const Passage> passages) {
  constexpr double kNear_m = 0.5;  // distance between doors of the graph and of the grid
  std::vector<bool> at_door(basins.saddles.size(), false);
  for (std::size_t k = 0; k < at_door.size(); ++k) {
    const Eigen::Vector2d at_m = frame.center_m(frame.cell_at(basins.saddles[k].cell));
    at_door[k] = std::any_of(passages.begin(), passages.end(), [&](const Passage& passage) {
      return (passage.position_m - at_m).norm() <= kNear_m;
    });
  }
  return at_door;
}

// Assigns the passable cells in a polygon that have no owner yet to `index`.
void fill_polygon(const FreeSpace& space, const std::vector<Eigen::Vector2d>& polygon_m,
                  std::uint32_t index, std::vector<std::uint32_t>& owner) {
  visit_cells_in(space.frame(), polygon_m, [&](const Cell& cell) {
    const std::size_t i = space.frame().index(cell);
    if (space.passable(i) && owner[i] == kNoLabel) owner[i] = index;
  });
}

// Removes the cells across drawn doors from their owners, so that these fall into parts there.
// Named zones stay whole.
void part_at_doors(const FreeSpace& space, const std::vector<std::string>& names,
                   std::vector<std::uint32_t>& owner) {
  for (const DrawnLine& line : space.rules().lines()) {
    if (line.kind != LineKind::kDoor) continue;
    for (const Cell& cell : cells_across(space.frame(), line.points_m.front(), line.points_m.back(),
                                         kOpeningReach_m)) {
      std::uint32_t& of_cell = owner[space.frame().index(cell)];
      if (of_cell != kNoLabel && names[of_cell].empty()) of_cell = kNoLabel;
    }
  }
}

ZoneLabels no_labels(const FreeSpace& space) {
  return {std::vector<std::uint32_t>(space.frame().size(), kNoLabel), {}, {}};
}

// Assigns the cells of drawn zones and appends their names; kNoLabel for other cells.
std::vector<std::uint32_t> owner_of_drawn(const FreeSpace& space, std::span<const DrawnZone> drawn,
                                          std::vector<std::string>& names) {
  std::vector<std::uint32_t> owner(space.frame().size(), kNoLabel);
  for (const DrawnZone& zone : drawn) {
    const auto index = static_cast<std::uint32_t>(names.size());
    names.push_back(zone.name);
    fill_polygon(space, zone.polygon_m, index, owner);
  }
  return owner;
}

// Assigns the passable cells without an owner to the rooms between the walls, appended without
// names.
void give_to_rooms(const FreeSpace& space, std::span<const Passage> passages,
                   const ZoneConfig& config, std::vector<std::string>& names,
                   std::vector<std::uint32_t>& owner) {
  const FreeSpace walls(without_furniture(space.grid(), config.rooms), {.forbidden_cells = 0.0});
  const Basins basins = clearance_basins(walls);
  const std::vector<std::uint32_t> room_of =
      rooms_of(basins, saddles_at_doors(space.frame(), basins, passages), config.rooms,
               space.frame().resolution_m);
  const auto first = static_cast<std::uint32_t>(names.size());
  names.resize(names.size() + basins.peak_m.size());
  for (std::size_t i = 0; i < owner.size(); ++i) {
    const std::uint32_t basin = basins.of_cell[i];
    const bool free = space.passable(i) && owner[i] == kNoLabel;
    if (free && basin != kNoBasin) owner[i] = first + room_of[basin];
  }
}

ZoneMap zones_of_owners(const FreeSpace& space, const std::vector<std::string>& names,
                        std::vector<std::uint32_t> owner, const ZoneConfig& config) {
  part_at_doors(space, names, owner);
  ZoneLabels labels = no_labels(space);
  label_parts(space, owner, names, labels);
  return complete(space, std::move(labels), config);
}

}  // namespace

Place moved(const Place& place, const geometry::Pose2& T) {
  Place out = place;
  out.position_m = T * place.position_m;
  if (place.station_heading_rad) {
    out.station_heading_rad = geometry::wrap_angle(*place.station_heading_rad + T.theta_rad);
  }
  return out;
}

std::vector<Passage> passages_of(const GlobalMap& map) {
  std::map<std::uint32_t, std::vector<Eigen::Vector2d>> ahead_of_node;
  for (const MapBranch& branch : map.branches) {
    if (branch.is_virtual || branch.points.size() < 2) continue;
    ahead_of_node[branch.node_a].push_back(point_ahead(branch.points, false));
    ahead_of_node[branch.node_b].push_back(point_ahead(branch.points, true));
  }
  std::vector<Passage> passages;
  for (const topomap::MapNode& node : map.nodes) {
    if (node.kind != NodeKind::kDoor && node.kind != NodeKind::kNarrowing) continue;
    const auto found = ahead_of_node.find(node.id);
    if (found == ahead_of_node.end()) continue;
    const std::vector<Eigen::Vector2d>& ahead = found->second;
    const Eigen::Vector2d behind = ahead.size() > 1 ? ahead[1] : node.position_m;
    const Eigen::Vector2d along = ahead[0] - behind;
    if (along.norm() > 0.0) {
      passages.push_back({node.position_m, along.normalized(), node.clearance_m});
    }
  }
  return passages;
}

ZoneMap zones_of_rooms(const FreeSpace& space, std::span<const Passage> passages,
                       const ZoneConfig& config) {
  check(config);
  std::vector<std::string> names;
  std::vector<std::uint32_t> owner(space.frame().size(), kNoLabel);
  give_to_rooms(space, passages, config, names, owner);
  return zones_of_owners(space, names, std::move(owner), config);
}

ZoneMap zones_by_width(const FreeSpace& space, const ZoneConfig& config) {
  check(config);
  const double half_cells = config.passage_half_width_m / space.frame().resolution_m;
  std::vector<std::uint32_t> owner = passable_owner(space);
  for (std::size_t i = 0; i < owner.size(); ++i) {
    if (space.squared_cells(i) <= half_cells * half_cells) owner[i] = kNoLabel;
  }
  ZoneLabels labels = no_labels(space);
  label_parts(space, owner, {""}, labels);
  return complete(space, std::move(labels), config);
}

ZoneMap drawn_zones(const FreeSpace& space, std::span<const DrawnZone> drawn,
                    const ZoneConfig& config) {
  check(config);
  std::vector<std::string> names;
  std::vector<std::uint32_t> owner = owner_of_drawn(space, drawn, names);
  // Cells outside of all polygons.
  const auto outside = static_cast<std::uint32_t>(names.size());
  names.emplace_back();
  for (std::size_t i = 0; i < owner.size(); ++i) {
    if (space.passable(i) && owner[i] == kNoLabel) owner[i] = outside;
  }
  return zones_of_owners(space, names, std::move(owner), config);
}

ZoneMap zones_of_drawn_and_found_rooms(const FreeSpace& space, std::span<const DrawnZone> drawn,
                                       std::span<const Passage> passages,
                                       const ZoneConfig& config) {
  check(config);
  std::vector<std::string> names;
  std::vector<std::uint32_t> owner = owner_of_drawn(space, drawn, names);
  give_to_rooms(space, passages, config, names, owner);
  return zones_of_owners(space, names, std::move(owner), config);
}

}  // namespace topogeo::planning
