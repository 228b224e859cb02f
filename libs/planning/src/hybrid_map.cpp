#include "topogeo/planning/hybrid_map.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

namespace topogeo::planning {
namespace {

using CellIndex = std::size_t;

// Indexed by pair of zones, ascending: neighbours in the second zone of each border cell of the
// first.
using Borders = std::map<std::pair<ZoneId, ZoneId>, std::map<CellIndex, std::vector<CellIndex>>>;

Borders find_borders(const GridFrame& frame, const ZoneMap& zones) {
  Borders borders;
  const auto width = static_cast<CellIndex>(frame.columns);
  const auto add = [&](CellIndex i, CellIndex j) {
    ZoneId zone_i = zones.zone_of_cell[i];
    ZoneId zone_j = zones.zone_of_cell[j];
    if (zone_i == zone_j || zone_i == kNoZone || zone_j == kNoZone) return;
    if (zone_j < zone_i) {
      std::swap(zone_i, zone_j);
      std::swap(i, j);
    }
    borders[{zone_i, zone_j}][i].push_back(j);
  };
  for (std::int32_t row = 0; row < frame.rows; ++row) {
    for (std::int32_t column = 0; column < frame.columns; ++column) {
      const CellIndex i = frame.index({column, row});
      if (column + 1 < frame.columns) add(i, i + 1);
      if (row + 1 < frame.rows) add(i, i + width);
    }
  }
  return borders;
}

// The cells connected to the first one over sides and corners; removed from `cells`.
std::vector<CellIndex> take_stretch(const GridFrame& frame, std::set<CellIndex>& cells) {
  std::vector<CellIndex> stretch{*cells.begin()};
  cells.erase(cells.begin());
  for (std::size_t done = 0; done < stretch.size(); ++done) {
    const Cell at = frame.cell_at(stretch[done]);
    for (std::int32_t row = at.row - 1; row <= at.row + 1; ++row) {
      for (std::int32_t column = at.column - 1; column <= at.column + 1; ++column) {
        if (!frame.contains({column, row})) continue;
        const auto found = cells.find(frame.index({column, row}));
        if (found == cells.end()) continue;
        stretch.push_back(*found);
        cells.erase(found);
      }
    }
  }
  std::sort(stretch.begin(), stretch.end());
  return stretch;
}

// The cell nearest to the mean of all.
Cell middle_of(const GridFrame& frame, const std::vector<CellIndex>& stretch) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const CellIndex i : stretch) {
    const Cell cell = frame.cell_at(i);
    mean += Eigen::Vector2d(cell.column, cell.row) / static_cast<double>(stretch.size());
  }
  const auto squared = [&](CellIndex i) {
    const Cell cell = frame.cell_at(i);
    return (Eigen::Vector2d(cell.column, cell.row) - mean).squaredNorm();
  };
  return frame.cell_at(
      *std::min_element(stretch.begin(), stretch.end(),
                        [&](CellIndex a, CellIndex b) { return squared(a) < squared(b); }));
}

void check_zones(const FreeSpace& space, const ZoneMap& zones) {
  if (zones.zone_of_cell.size() != space.frame().size()) {
    throw std::invalid_argument("hybrid map: zones of " +
                                std::to_string(zones.zone_of_cell.size()) +
                                " cells, the grid has " + std::to_string(space.frame().size()));
  }
  for (std::size_t i = 0; i < zones.zone_of_cell.size(); ++i) {
    const ZoneId zone = zones.zone_of_cell[i];
    if (zone == kNoZone ? !space.passable(i) : space.passable(i) && zone < zones.zones.size()) {
      continue;
    }
    throw std::invalid_argument("hybrid map: cell " + std::to_string(i) +
                                " is passable without a zone, or in a zone and not passable");
  }
}

void check_places(const std::vector<Place>& places) {
  std::set<std::string> names;
  for (const Place& place : places) {
    if (place.name.empty() || !names.insert(place.name).second) {
      throw std::invalid_argument("hybrid map: the place name '" + place.name +
                                  "' is empty or taken");
    }
  }
}

}  // namespace

HybridMap::HybridMap(FreeSpace space, ZoneMap zones, std::vector<Place> places)
    : space_(std::move(space)),
      zones_(std::move(zones)),
      places_(std::move(places)),
      graph_(0, {}) {
  check_zones(space_, zones_);
  check_places(places_);
  nodes_of_zone_.resize(zones_.zones.size());
  find_nodes();
  find_edges();
}

void HybridMap::find_nodes() {
  for (const auto& [pair, neighbours] : find_borders(frame(), zones_)) {
    std::set<CellIndex> left;
    for (const auto& [cell, others] : neighbours) left.insert(cell);
    while (!left.empty()) {
      const std::vector<CellIndex> stretch = take_stretch(frame(), left);
      BorderNode node;
      node.id = static_cast<std::uint32_t>(nodes_.size());
      node.zones = {pair.first, pair.second};
      node.cells[0] = middle_of(frame(), stretch);
      node.cells[1] = frame().cell_at(neighbours.at(frame().index(node.cells[0])).front());
      node.position_m = 0.5 * (frame().center_m(node.cells[0]) + frame().center_m(node.cells[1]));
      node.clearance_m =
          std::min(space_.clearance_m(node.cells[0]), space_.clearance_m(node.cells[1]));
      std::set<CellIndex> other_side;
      for (const CellIndex i : stretch) {
        node.border[0].push_back(frame().cell_at(i));
        other_side.insert(neighbours.at(i).begin(), neighbours.at(i).end());
      }
      for (const CellIndex i : other_side) node.border[1].push_back(frame().cell_at(i));
      for (const ZoneId zone : node.zones) nodes_of_zone_[zone].push_back(node.id);
      nodes_.push_back(std::move(node));
    }
  }
}

void HybridMap::find_edges() {
  std::vector<GraphEdge> graph_edges;
  for (const Zone& zone : zones_.zones) {
    const std::vector<std::uint32_t>& ids = nodes_of_zone_[zone.id];
    if (ids.size() < 2) continue;
    const SearchWindow window(frame(), zone.box, zones_.zone_of_cell, zone.id);
    std::vector<Cell> cells;
    cells.reserve(ids.size());
    for (const std::uint32_t id : ids) cells.push_back(nodes_[id].cell_in(zone.id));
    for (std::size_t i = 0; i + 1 < ids.size(); ++i) {
      const std::vector<Cell> others(cells.begin() + static_cast<std::ptrdiff_t>(i + 1),
                                     cells.end());
      auto paths = shortest_paths(window, cells[i], others);
      for (std::size_t k = 0; k < others.size(); ++k) {
        if (!paths[k]) {
          throw std::invalid_argument("hybrid map: zone " + std::to_string(zone.id) +
                                      " is not connected");
        }
        // Adds half of the step across the border at either end.
        const double cost_m = (paths[k]->cost_cells + 1.0) * frame().resolution_m;
        const auto id = static_cast<std::uint32_t>(edges_.size());
        const std::uint32_t other = ids[i + 1 + k];
        edges_.push_back({id, ids[i], other, zone.id, cost_m, std::move(paths[k]->cells)});
        graph_edges.push_back({ids[i], other, cost_m});
      }
    }
  }
  graph_ = RouteGraph(nodes_.size(), graph_edges);
}

}  // namespace topogeo::planning
