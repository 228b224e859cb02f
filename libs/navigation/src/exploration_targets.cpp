// What is left to be seen of a floor, whether or not it can be reached.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "topogeo/navigation/explorer.hpp"
#include "topogeo/planning/zones.hpp"

#include "grid_view.hpp"

namespace topogeo::navigation {

using planning::Cell;
using planning::CellState;

namespace {

/// On the threshold: that is not inside.
bool at_border(const planning::HybridMap& map, planning::ZoneId zone,
               const Eigen::Vector2d& point_m) {
  constexpr double kThreshold_m = 0.5;
  const std::vector<std::uint32_t>& nodes = map.nodes_of(zone);
  return std::any_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) {
    return (map.nodes()[node].position_m - point_m).norm() < kThreshold_m;
  });
}

}  // namespace

std::vector<Explorer::Candidate> Explorer::candidates(const topomap::GlobalMap& graph,
                                                      const planning::HybridMap& map) const {
  std::vector<Candidate> found;
  add_branch_ends(graph, map, found);
  add_passages(graph, map, found);
  add_gaps(map, found);
  add_rooms(map, found);
  std::erase_if(found, [this](const Candidate& candidate) {
    return dropped(candidate.kind, candidate.position_m);
  });
  return found;
}

void Explorer::add_branch_ends(const topomap::GlobalMap& graph, const planning::HybridMap& map,
                               std::vector<Candidate>& found) const {
  std::map<std::uint32_t, int> branches;
  for (const topomap::MapBranch& branch : graph.branches) {
    ++branches[branch.node_a];
    ++branches[branch.node_b];
  }
  for (const topomap::MapNode& node : graph.nodes) {
    if (node.kind != topomap::NodeKind::kFictitious || branches[node.id] > 1) continue;
    if (unknown_near(map.space().grid(), node.position_m, config_.unknown_near_m)) {
      found.push_back({TargetKind::kBranchEnd, node.position_m});
    }
  }
}

void Explorer::add_passages(const topomap::GlobalMap& graph, const planning::HybridMap& map,
                            std::vector<Candidate>& found) const {
  for (const planning::Passage& passage : planning::passages_of(graph)) {
    for (const double side : {-1.0, 1.0}) {
      const Eigen::Vector2d side_m =
          passage.position_m + side * config_.passage_side_m * passage.along;
      const auto cell = map.frame().cell_of(side_m);
      if (cell && map.space().grid().at(*cell) != CellState::kUnknown) continue;
      found.push_back({TargetKind::kPassage, side_m});
    }
  }
}

// Squares of the floor with enough free cells beside unknown ones, each at the one of these cells
// that is nearest to their middle.
void Explorer::add_gaps(const planning::HybridMap& map, std::vector<Candidate>& found) const {
  const planning::OccupancyGrid& grid = map.space().grid();
  const double resolution_m = map.frame().resolution_m;
  const auto side = static_cast<std::int32_t>(std::lround(config_.gap_side_m / resolution_m));
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<Cell>> squares;
  for (std::int32_t row = 0; row < map.frame().rows; ++row) {
    for (std::int32_t column = 0; column < map.frame().columns; ++column) {
      const Cell cell{column, row};
      if (grid.at(cell) == CellState::kFree && beside_unknown(grid, cell)) {
        squares[{row / side, column / side}].push_back(cell);
      }
    }
  }
  for (const auto& [square, cells] : squares) {
    const double length_m = static_cast<double>(cells.size()) * resolution_m;
    if (length_m < config_.least_gap_m) continue;
    Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
    for (const Cell& cell : cells) middle_m += map.frame().center_m(cell);
    middle_m /= static_cast<double>(cells.size());
    Eigen::Vector2d best_m = map.frame().center_m(cells.front());
    for (const Cell& cell : cells) {
      const Eigen::Vector2d at_m = map.frame().center_m(cell);
      if ((at_m - middle_m).squaredNorm() < (best_m - middle_m).squaredNorm()) best_m = at_m;
    }
    found.push_back({TargetKind::kGap, best_m, config_.gap_worth * length_m});
  }
}

// The zones that no visited pose lies in, each at the cell that is furthest from everything.
void Explorer::add_rooms(const planning::HybridMap& map, std::vector<Candidate>& found) const {
  const auto& zones = map.zones().zones;
  std::vector<bool> entered(zones.size(), false);
  for (const geometry::Pose2& pose : visited_) {
    const auto cell = map.frame().cell_of(pose.position_m());
    const planning::ZoneId zone = cell ? map.zone_of(*cell) : planning::kNoZone;
    if (zone != planning::kNoZone && !at_border(map, zone, pose.position_m())) entered[zone] = true;
  }
  const double cell_m2 = map.frame().resolution_m * map.frame().resolution_m;
  for (const planning::Zone& zone : zones) {
    if (entered[zone.id] || static_cast<double>(zone.cells) * cell_m2 < config_.least_zone_m2) {
      continue;
    }
    std::optional<Cell> widest;
    for (std::int32_t row = zone.box.low.row; row <= zone.box.high.row; ++row) {
      for (std::int32_t column = zone.box.low.column; column <= zone.box.high.column; ++column) {
        const Cell cell{column, row};
        if (map.zone_of(cell) != zone.id) continue;
        if (!widest || map.space().clearance_m(cell) > map.space().clearance_m(*widest)) {
          widest = cell;
        }
      }
    }
    if (widest) found.push_back({TargetKind::kRoom, map.frame().center_m(*widest)});
  }
}

}  // namespace topogeo::navigation
