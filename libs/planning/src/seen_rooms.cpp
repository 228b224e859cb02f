#include "seen_rooms.hpp"

#include <cstddef>
#include <cstdint>

#include "cell_neighbours.hpp"

namespace topogeo::planning {
namespace {

// Shares of the outline of a zone: a wedge that is seen through a door has more than half next to
// unknown cells, a room seen from inside less than a third
// (tests/unit/planning/rooms_while_mapping_test).
constexpr double kOpenIfEntered = 0.35;
constexpr double kOpenIfSeen = 0.15;
constexpr double kSlits_m2 = 0.25;  // unknown cells between beams and behind legs of furniture

/// Unknown cells whose connected area is more than a slit.
std::vector<bool> unknown_areas(const OccupancyGrid& grid) {
  const GridFrame& frame = grid.frame();
  const double most_cells = kSlits_m2 / (frame.resolution_m * frame.resolution_m);
  std::vector<bool> in_area(frame.size(), false);
  std::vector<bool> taken(frame.size(), false);
  std::vector<std::size_t> area;
  for (std::size_t first = 0; first < taken.size(); ++first) {
    if (taken[first] || grid.cells()[first] != CellState::kUnknown) continue;
    area.assign(1, first);
    taken[first] = true;
    for (std::size_t done = 0; done < area.size(); ++done) {
      visit_neighbours(frame, area[done], [&](std::size_t j) {
        if (taken[j] || grid.cells()[j] != CellState::kUnknown) return;
        taken[j] = true;
        area.push_back(j);
      });
    }
    if (static_cast<double>(area.size()) <= most_cells) continue;
    for (const std::size_t i : area) in_area[i] = true;
  }
  return in_area;
}

struct Outline {
  std::size_t cells = 0;
  std::size_t open = 0;  // of these, next to unknown ones
  bool entered = false;

  [[nodiscard]] bool seen_well() const {
    const double most = entered ? kOpenIfEntered : kOpenIfSeen;
    return static_cast<double>(open) <= most * static_cast<double>(cells);
  }
};

}  // namespace

std::vector<bool> zones_seen_well(const FreeSpace& space, const StopPoses& poses,
                                  const ZoneMap& zones) {
  const GridFrame& frame = space.frame();
  const std::vector<bool> unknown = unknown_areas(space.seen());
  std::vector<Outline> outlines(zones.zones.size());
  for (std::size_t i = 0; i < zones.zone_of_cell.size(); ++i) {
    const ZoneId zone = zones.zone_of_cell[i];
    if (zone == kNoZone) continue;
    bool at_edge = false;
    bool open = false;
    visit_neighbours(frame, i, [&](std::size_t j) {
      at_edge = at_edge || zones.zone_of_cell[j] != zone;
      open = open || unknown[j];
    });
    if (at_edge) ++outlines[zone].cells;
    if (open) ++outlines[zone].open;
  }
  for (const auto& [stop, T_map_stop] : poses) {
    const auto cell = frame.cell_of(T_map_stop.position_m());
    const ZoneId zone = cell ? zones.zone_of_cell[frame.index(*cell)] : kNoZone;
    if (zone != kNoZone) outlines[zone].entered = true;
  }
  std::vector<bool> seen_well;
  seen_well.reserve(outlines.size());
  for (const Outline& outline : outlines) seen_well.push_back(outline.seen_well());
  return seen_well;
}

}  // namespace topogeo::planning
