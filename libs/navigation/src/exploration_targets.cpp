// Candidates of exploration, reachable or not.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "topogeo/navigation/explorer.hpp"
#include "topogeo/planning/zones.hpp"

#include "grid_view.hpp"
#include "rooms.hpp"
#include "unknown_floor.hpp"

namespace topogeo::navigation {

using planning::Cell;
using planning::CellState;

namespace {

constexpr double kEntrance_m = 1.5;  // greatest length of an entrance that noise has narrowed
constexpr std::array<Cell, 8> kAround = {Cell{1, 0},  Cell{1, 1},   Cell{0, 1},  Cell{-1, 1},
                                         Cell{-1, 0}, Cell{-1, -1}, Cell{0, -1}, Cell{1, -1}};

}  // namespace

std::vector<Explorer::Candidate> Explorer::candidates(const topomap::GlobalMap& graph,
                                                      const planning::HybridMap& map,
                                                      const Rooms& rooms) const {
  const UnknownFloor unknown(map.space());
  std::vector<Candidate> found;
  const auto add = [&](TargetKind kind, const std::vector<Eigen::Vector2d>& positions_m) {
    for (const Eigen::Vector2d& position_m : positions_m) {
      if (dropped(kind, position_m)) continue;
      const double area_m2 = unknown.ahead_m2(position_m, config_.unknown_near_m, config_.sight_m);
      if (area_m2 < config_.least_area_m2 || area_m2 <= 0.0) continue;
      found.push_back({kind, position_m, config_.worth_m_per_m2 * area_m2});
    }
  };
  add(TargetKind::kBranchEnd, branch_ends(graph));
  add(TargetKind::kPassage, passage_sides(graph, map));
  add(TargetKind::kGap, gaps(map, unknown));
  add_rooms(map, rooms, found);
  return found;
}

bool Explorer::open(const ExplorationTarget& target, const planning::HybridMap& map) const {
  const auto cell = map.frame().cell_of(target.position_m);
  if (target.kind == TargetKind::kRoom) {
    const Rooms rooms(map);
    const planning::ZoneId room = cell ? rooms.at(*cell) : planning::kNoZone;
    return room != planning::kNoZone && !rooms.entered(room, visited_);
  }
  const planning::ZoneId zone = cell ? map.zone_of(*cell) : planning::kNoZone;
  if (target.kind == TargetKind::kBlocked) {
    return zone != planning::kNoZone && !reachable_zones(map, target.T_map_view.position_m())[zone];
  }
  if (target.kind == TargetKind::kPassage && cell &&
      map.space().grid().at(*cell) != CellState::kUnknown) {
    return false;
  }
  const UnknownFloor unknown(map.space());
  const double area_m2 =
      unknown.ahead_m2(target.position_m, config_.unknown_near_m, config_.sight_m);
  return area_m2 >= config_.least_area_m2 && area_m2 > 0.0;
}

std::vector<Eigen::Vector2d> Explorer::branch_ends(const topomap::GlobalMap& graph) const {
  std::map<std::uint32_t, int> branches;
  for (const topomap::MapBranch& branch : graph.branches) {
    ++branches[branch.node_a];
    ++branches[branch.node_b];
  }
  std::vector<Eigen::Vector2d> found_m;
  for (const topomap::MapNode& node : graph.nodes) {
    if (node.kind != topomap::NodeKind::kFictitious || branches[node.id] > 1) continue;
    found_m.push_back(node.position_m);
  }
  return found_m;
}

std::vector<Eigen::Vector2d> Explorer::passage_sides(const topomap::GlobalMap& graph,
                                                     const planning::HybridMap& map) const {
  std::vector<Eigen::Vector2d> found_m;
  for (const planning::Passage& passage : planning::passages_of(graph)) {
    for (const double side : {-1.0, 1.0}) {
      const Eigen::Vector2d side_m =
          passage.position_m + side * config_.passage_side_m * passage.along;
      const auto cell = map.frame().cell_of(side_m);
      if (cell && map.space().grid().at(*cell) != CellState::kUnknown) continue;
      found_m.push_back(side_m);
    }
  }
  return found_m;
}

// Squares of the floor with enough free cells beside unknown ones. The cell nearest to the middle
// of these cells represents the square.
std::vector<Eigen::Vector2d> Explorer::gaps(const planning::HybridMap& map,
                                            const UnknownFloor& unknown) const {
  const planning::OccupancyGrid& grid = map.space().grid();
  const double resolution_m = map.frame().resolution_m;
  const auto side = static_cast<std::int32_t>(std::lround(config_.gap_side_m / resolution_m));
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<Cell>> squares;
  for (std::int32_t row = 0; row < map.frame().rows; ++row) {
    for (std::int32_t column = 0; column < map.frame().columns; ++column) {
      const Cell cell{column, row};
      if (grid.at(cell) == CellState::kFree && unknown.beside(cell)) {
        squares[{row / side, column / side}].push_back(cell);
      }
    }
  }
  std::vector<Eigen::Vector2d> found_m;
  for (const auto& [square, cells] : squares) {
    if (static_cast<double>(cells.size()) * resolution_m < config_.least_gap_m) continue;
    Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
    for (const Cell& cell : cells) middle_m += map.frame().center_m(cell);
    middle_m /= static_cast<double>(cells.size());
    Eigen::Vector2d best_m = map.frame().center_m(cells.front());
    for (const Cell& cell : cells) {
      const Eigen::Vector2d at_m = map.frame().center_m(cell);
      if ((at_m - middle_m).squaredNorm() < (best_m - middle_m).squaredNorm()) best_m = at_m;
    }
    found_m.push_back(best_m);
  }
  return found_m;
}

// The rooms without a visited pose, each at its cell farthest from obstacles.
void Explorer::add_rooms(const planning::HybridMap& map, const Rooms& rooms,
                         std::vector<Candidate>& found) const {
  const double cell_m2 = map.frame().resolution_m * map.frame().resolution_m;
  for (const planning::Zone& room : rooms.all()) {
    if (static_cast<double>(room.cells) * cell_m2 < config_.least_room_m2) continue;
    if (rooms.entered(room.id, visited_)) continue;
    const std::optional<Cell> widest = rooms.widest(room);
    if (!widest || dropped(TargetKind::kRoom, map.frame().center_m(*widest))) continue;
    found.push_back({TargetKind::kRoom, map.frame().center_m(*widest),
                     std::numeric_limits<double>::infinity()});
  }
}

// The zones that are joined to a reachable one by free cells, but too narrow for the robot over a
// short distance; each at its cell nearest along these cells.
std::vector<Explorer::Candidate> Explorer::blocked_zones(const planning::HybridMap& map,
                                                         const std::vector<bool>& reachable) const {
  std::vector<std::optional<Cell>> entrances(reachable.size());
  std::vector<std::uint8_t> visited(map.frame().size(), 0);
  std::vector<Cell> front;
  const auto visit = [&](const Cell& cell) {
    if (visited[map.frame().index(cell)] != 0) return;
    visited[map.frame().index(cell)] = 1;
    front.push_back(cell);
  };
  for (std::size_t i = 0; i < map.frame().size(); ++i) {
    const planning::ZoneId zone = map.zone_of(map.frame().cell_at(i));
    if (zone != planning::kNoZone && reachable[zone]) visit(map.frame().cell_at(i));
  }
  const double resolution_m = map.frame().resolution_m;
  for (double distance_m = 0.0; distance_m < kEntrance_m; distance_m += resolution_m) {
    for (const Cell& cell : std::exchange(front, {})) {
      for (const Cell& step : kAround) {
        const Cell other{cell.column + step.column, cell.row + step.row};
        if (!map.frame().contains(other) || map.space().grid().at(other) != CellState::kFree) {
          continue;
        }
        const planning::ZoneId zone = map.zone_of(other);
        if (zone != planning::kNoZone && !entrances[zone]) entrances[zone] = other;
        visit(other);
      }
    }
  }
  std::vector<Candidate> found;
  for (const planning::Zone& zone : map.zones().zones) {
    const double area_m2 = static_cast<double>(zone.cells) * resolution_m * resolution_m;
    if (reachable[zone.id] || !entrances[zone.id] || area_m2 < config_.least_room_m2) continue;
    const Eigen::Vector2d at_m = map.frame().center_m(*entrances[zone.id]);
    if (dropped(TargetKind::kBlocked, at_m)) continue;
    found.push_back({TargetKind::kBlocked, at_m, config_.worth_m_per_m2 * area_m2});
  }
  return found;
}

}  // namespace topogeo::navigation
