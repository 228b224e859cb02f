#include "grid_links.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "topogeo/exchange/grid_map.hpp"
#include "topogeo/planning/grid_search.hpp"

#include "graph_parts.hpp"
#include "segments.hpp"

namespace topogeo::exchange {
namespace {

using planning::Cell;
using topomap::MapBranch;
using topomap::MapNode;

/// The graph serves a place within this distance along straight steps of the free space. A room of
/// usual size gets one node.
constexpr double kServed_m = 6.0;

/// For each node, in their order, the number of its part.
std::vector<std::size_t> parts_of_nodes(const topomap::GlobalMap& map) {
  GraphParts joined(map.nodes);
  for (const MapBranch& branch : map.branches) {
    if (!branch.is_virtual) joined.join(branch);
  }
  std::vector<std::size_t> parts(map.nodes.size());
  for (std::size_t i = 0; i < parts.size(); ++i) parts[i] = joined.part(i);
  return parts;
}

/// A number for a new node, below those of virtual ones.
std::uint32_t next_node_id(const topomap::GlobalMap& map) {
  constexpr std::uint32_t kFirstVirtual = 1U << 31U;
  std::uint32_t next = 0;
  for (const MapNode& node : map.nodes) {
    if (node.id < kFirstVirtual) next = std::max(next, node.id + 1);
  }
  return next;
}

std::uint32_t next_branch_id(const topomap::GlobalMap& map) {
  std::uint32_t next = 0;
  for (const MapBranch& branch : map.branches) next = std::max(next, branch.id + 1);
  return next;
}

/// For each cell the number of the connected part of the free space that it lies in, from 1; 0: not
/// passable. A diagonal step needs both cells beside it, so four neighbours decide.
std::vector<std::uint32_t> connected_parts(const planning::FreeSpace& space) {
  const planning::GridFrame& frame = space.frame();
  std::vector<std::uint32_t> parts(frame.size(), 0);
  std::vector<std::size_t> edge;
  std::uint32_t last = 0;
  for (std::size_t first = 0; first < frame.size(); ++first) {
    if (parts[first] != 0 || !space.passable(first)) continue;
    parts[first] = ++last;
    edge.assign(1, first);
    while (!edge.empty()) {
      const Cell cell = frame.cell_at(edge.back());
      edge.pop_back();
      for (const Cell& beside :
           {Cell{cell.column + 1, cell.row}, Cell{cell.column - 1, cell.row},
            Cell{cell.column, cell.row + 1}, Cell{cell.column, cell.row - 1}}) {
        if (!space.passable(beside)) continue;
        std::uint32_t& part = parts[frame.index(beside)];
        if (part != 0) continue;
        part = last;
        edge.push_back(frame.index(beside));
      }
    }
  }
  return parts;
}

class Linker {
 public:
  Linker(topomap::GlobalMap& map, const planning::FreeSpace& space)
      : map_(map), space_(space), connected_(connected_parts(space)) {
    slowness_.resize(space.frame().size());
    for (std::size_t i = 0; i < slowness_.size(); ++i) {
      // So that a path keeps to the middle where the free space is narrower than this.
      constexpr double kWide_m = 4.0;
      const double clearance_m = space_.clearance_m(space_.frame().cell_at(i));
      slowness_[i] = static_cast<float>(
          std::max(1.0, kWide_m / std::max(clearance_m, space_.frame().resolution_m)));
    }
  }

  /// Adds nodes at places that the graph does not serve.
  void serve(std::span<const Eigen::Vector2d> places_m) {
    const planning::GridFrame& frame = space_.frame();
    away_cells_.assign(frame.size(), std::numeric_limits<float>::infinity());
    std::vector<Cell> graph;
    const auto add = [&](const Eigen::Vector2d& position_m) {
      if (const auto cell = frame.cell_of(position_m)) graph.push_back(*cell);
    };
    for (const MapNode& node : map_.nodes) add(node.position_m);
    for (const MapBranch& branch : map_.branches) {
      for (const topomap::BranchPoint& p : branch.points) add(p.position_m);
    }
    spread(graph);
    for (const Eigen::Vector2d& place_m : places_m) {
      const auto cell = frame.cell_of(place_m);
      if (!cell || !space_.passable(*cell)) continue;
      if (away_cells_[frame.index(*cell)] * frame.resolution_m <= kServed_m) continue;
      MapNode node;
      node.id = next_node_id(map_);
      node.position_m = frame.center_m(*cell);
      node.clearance_m = clearance_m(*cell);
      map_.nodes.push_back(node);
      spread({*cell});
    }
  }

  void link() {
    std::vector<std::uint32_t> alone;  // nodes of parts that no free path leaves
    while (link_one(alone)) {
    }
    std::ranges::sort(map_.nodes, {}, &MapNode::id);
  }

 private:
  /// Lowers the distances of all cells to those from the given ones, step by step over straight
  /// neighbours.
  void spread(std::vector<Cell> cells) {
    const planning::GridFrame& frame = space_.frame();
    for (const Cell& cell : cells) away_cells_[frame.index(cell)] = 0.0F;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const Cell cell = cells[i];
      const float next = away_cells_[frame.index(cell)] + 1.0F;
      for (const Cell& beside :
           {Cell{cell.column + 1, cell.row}, Cell{cell.column - 1, cell.row},
            Cell{cell.column, cell.row + 1}, Cell{cell.column, cell.row - 1}}) {
        if (!space_.passable(beside) || away_cells_[frame.index(beside)] <= next) continue;
        away_cells_[frame.index(beside)] = next;
        cells.push_back(beside);
      }
    }
  }

  struct PartCells {
    std::vector<Cell> own;
    std::vector<Cell> others;
  };

  /// Links the smallest part that may have a link. False: none is left.
  bool link_one(std::vector<std::uint32_t>& alone) {
    const std::vector<std::size_t> parts = parts_of_nodes(map_);
    std::map<std::size_t, std::size_t> sizes;
    for (const std::size_t part : parts) ++sizes[part];
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (std::ranges::find(alone, map_.nodes[i].id) != alone.end()) sizes.erase(parts[i]);
    }
    if (sizes.empty()) return false;
    const std::size_t part =
        std::ranges::min_element(sizes, {}, [](const auto& entry) { return entry.second; })->first;
    const auto path = path_from(cells_of(part, parts));
    if (!path) {
      alone.push_back(map_.nodes[part].id);
      return true;
    }
    add_branch(*path);
    return true;
  }

  PartCells cells_of(std::size_t part, const std::vector<std::size_t>& parts) const {
    PartCells cells;
    std::map<std::uint32_t, bool> own;
    const auto add = [&](const Eigen::Vector2d& position_m, bool is_own) {
      const auto cell = space_.frame().cell_of(position_m);
      if (cell && space_.passable(*cell)) (is_own ? cells.own : cells.others).push_back(*cell);
    };
    for (std::size_t i = 0; i < parts.size(); ++i) {
      own[map_.nodes[i].id] = parts[i] == part;
      add(map_.nodes[i].position_m, parts[i] == part);
    }
    for (const MapBranch& branch : map_.branches) {
      if (branch.is_virtual) continue;
      for (const topomap::BranchPoint& p : branch.points) add(p.position_m, own[branch.node_a]);
    }
    return cells;
  }

  /// The path of cells from the part to the nearest other one.
  std::optional<std::vector<Cell>> path_from(const PartCells& cells) {
    if (cells.own.empty() || cells.others.empty()) return std::nullopt;
    // Within the part nothing is driven, so any of its cells can be the start.
    std::map<std::size_t, float> former;
    for (const Cell& cell : cells.own) {
      const std::size_t index = space_.frame().index(cell);
      former.emplace(index, std::exchange(slowness_[index], 0.0F));
    }
    const auto path = path_from_any(cells);
    for (const auto& [index, slowness] : former) slowness_[index] = slowness;
    if (!path) return std::nullopt;
    const auto is_own = [&](const Cell& cell) {
      return former.contains(space_.frame().index(cell));
    };
    const auto last = std::find_if(path->cells.rbegin(), path->cells.rend(), is_own);
    return std::vector<Cell>(last.base() - 1, path->cells.end());
  }

  /// Tries several cells, because a passage of the part may be too narrow for the robot.
  [[nodiscard]] std::optional<planning::CellPath> path_from_any(const PartCells& cells) const {
    constexpr std::size_t kTries = 8;
    const auto connected = [&](const Cell& cell) { return connected_[space_.frame().index(cell)]; };
    std::set<std::uint32_t> with_others;
    for (const Cell& cell : cells.others) with_others.insert(connected(cell));
    const std::size_t step = std::max<std::size_t>(1, cells.own.size() / kTries);
    for (std::size_t i = 0; i < cells.own.size(); i += step) {
      // A search in vain visits the whole grid.
      if (!with_others.contains(connected(cells.own[i]))) continue;
      if (auto path = path_from_one(cells.own[i], cells)) return path;
    }
    return std::nullopt;
  }

  /// Searches around the part before it searches the whole grid, which takes long. All cells of
  /// the part lie in the box, and every step beyond them costs its length or more. So a path that
  /// leaves a box with this margin costs more than one that is shorter than the margin, and the
  /// cost of a path that was found is margin enough.
  [[nodiscard]] std::optional<planning::CellPath> path_from_one(const Cell& start,
                                                                const PartCells& cells) const {
    constexpr std::int32_t kFirstMargin = 100;
    constexpr std::int32_t kGrowth = 4;
    constexpr double kFirstStep = 1.0;  // from a cell of the part, where half a step is free
    const planning::GridFrame& frame = space_.frame();
    const planning::CellBox part = box_around(cells.own);
    for (std::int32_t margin = kFirstMargin;;) {
      const planning::CellBox box = planning::grown(part, margin, frame);
      const bool is_whole = box.low.column == 0 && box.low.row == 0 &&
                            box.high.column == frame.columns - 1 && box.high.row == frame.rows - 1;
      planning::SearchWindow window(space_, box);
      window.set_slowness(frame, slowness_);
      auto path = planning::path_to_nearest(window, start, cells.others);
      if (is_whole || (path && path->cost_cells < margin - kFirstStep)) return path;
      margin *= kGrowth;
      if (path) margin = std::min(margin, static_cast<std::int32_t>(path->cost_cells) + 2);
    }
  }

  /// A grid without an obstacle is as wide as it is large.
  [[nodiscard]] double clearance_m(const Cell& cell) const {
    const planning::GridFrame& frame = space_.frame();
    return std::min(space_.clearance_m(cell),
                    frame.resolution_m * std::hypot(frame.columns, frame.rows));
  }

  static planning::CellBox box_around(std::span<const Cell> cells) {
    planning::CellBox box{cells.front(), cells.front()};
    for (const Cell& cell : cells) {
      box.low = {std::min(box.low.column, cell.column), std::min(box.low.row, cell.row)};
      box.high = {std::max(box.high.column, cell.column), std::max(box.high.row, cell.row)};
    }
    return box;
  }

  void add_branch(const std::vector<Cell>& path) {
    MapBranch branch;
    const planning::GridFrame& frame = space_.frame();
    branch.node_a = node_at(frame.center_m(path.front()));
    branch.node_b = node_at(frame.center_m(path.back()));
    branch.id = next_branch_id(map_);
    for (const Cell& cell : path) {
      branch.points.push_back({frame.center_m(cell), clearance_m(cell)});
    }
    if (branch.points.size() < 2) branch.points.push_back(branch.points.front());
    branch.points.front().position_m = position_of(branch.node_a);
    branch.points.back().position_m = position_of(branch.node_b);
    map_.branches.push_back(std::move(branch));
  }

  [[nodiscard]] const Eigen::Vector2d& position_of(std::uint32_t id) const {
    return std::ranges::find(map_.nodes, id, &MapNode::id)->position_m;
  }

  /// The node nearest to a position; a new one on the nearest branch if that is nearer by more than
  /// a cell.
  std::uint32_t node_at(const Eigen::Vector2d& position_m) {
    const auto node = std::ranges::min_element(
        map_.nodes, {}, [&](const MapNode& one) { return distance(one.position_m, position_m); });
    const double to_node_m = distance(node->position_m, position_m);
    double nearest_m = std::numeric_limits<double>::infinity();
    std::pair<std::size_t, std::size_t> nearest{};
    for (std::size_t b = 0; b < map_.branches.size(); ++b) {
      if (map_.branches[b].is_virtual) continue;
      const auto& points = map_.branches[b].points;
      for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        const double away_m = distance(points[i].position_m, position_m);
        if (away_m < nearest_m) {
          nearest_m = away_m;
          nearest = {b, i};
        }
      }
    }
    if (to_node_m <= nearest_m + space_.frame().resolution_m) return node->id;
    return split(nearest.first, nearest.second);
  }

  /// Makes a point of a branch a node.
  std::uint32_t split(std::size_t index, std::size_t point) {
    MapBranch rest = map_.branches[index];
    MapNode node;
    node.id = next_node_id(map_);
    node.position_m = rest.points[point].position_m;
    node.clearance_m = rest.points[point].clearance_m;
    node.observations = rest.observations;
    node.last_seen_ns = rest.last_seen_ns;
    map_.branches[index].node_b = node.id;
    map_.branches[index].points.resize(point + 1);
    rest.id = next_branch_id(map_);
    rest.node_a = node.id;
    rest.points.erase(rest.points.begin(),
                      rest.points.begin() + static_cast<std::ptrdiff_t>(point));
    map_.branches.push_back(std::move(rest));
    map_.nodes.push_back(node);
    return node.id;
  }

  topomap::GlobalMap& map_;
  const planning::FreeSpace& space_;
  std::vector<std::uint32_t> connected_;  // connected part of each cell
  std::vector<float> slowness_{};         // of each cell
  std::vector<float> away_cells_{};  // distance of each cell from the graph along the free space
};

}  // namespace

std::size_t parts_of_graph(const topomap::GlobalMap& map) {
  std::vector<std::size_t> parts = parts_of_nodes(map);
  std::ranges::sort(parts);
  return static_cast<std::size_t>(std::unique(parts.begin(), parts.end()) - parts.begin());
}

void link_parts(topomap::GlobalMap& map, const planning::FreeSpace& space,
                std::span<const Eigen::Vector2d> places_m) {
  Linker linker(map, space);
  linker.serve(places_m);
  linker.link();
}

}  // namespace topogeo::exchange
