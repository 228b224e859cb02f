#include "drawn_obstructions.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

#include "topogeo/support/format.hpp"

#include "polygon_cells.hpp"

namespace topogeo::planning {
namespace {

constexpr double kFar_m = std::numeric_limits<double>::infinity();

// Same order as CellGraph.
constexpr std::array<Cell, 8> kSteps = {
    {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};

double distance_m(const Eigen::Vector2d& point_m, const Eigen::Vector2d& a_m,
                  const Eigen::Vector2d& b_m) {
  const Eigen::Vector2d line_m = b_m - a_m;
  const double length2 = line_m.squaredNorm();
  const double share =
      length2 > 0.0 ? std::clamp((point_m - a_m).dot(line_m) / length2, 0.0, 1.0) : 0.0;
  return (point_m - a_m - share * line_m).norm();
}

double distance_m(const Eigen::Vector2d& point_m, const std::vector<Eigen::Vector2d>& line_m,
                  bool closed) {
  double least_m = kFar_m;
  for (std::size_t i = closed ? 0 : 1; i < line_m.size(); ++i) {
    const Eigen::Vector2d& before_m = i == 0 ? line_m.back() : line_m[i - 1];
    least_m = std::min(least_m, distance_m(point_m, before_m, line_m[i]));
  }
  return least_m;
}

std::string quoted(const std::string& name) {
  return "'" + name + "'";
}

std::string text_of(const DrawnLine& wall) {
  return wall.name.empty() ? "a drawn wall" : quoted(wall.name);
}

/// The no-go zone or drawn wall that is nearest to a point.
struct Nearest {
  const DrawnZone* zone = nullptr;
  const DrawnLine* wall = nullptr;
  double away_m = kFar_m;  // 0 inside of a zone
};

Nearest nearest_item(const DrivingRules& rules, const Eigen::Vector2d& point_m) {
  Nearest nearest;
  for (const DrawnZone& zone : rules.zones()) {
    if (zone.kind != ZoneKind::kNoGo) continue;
    const double away_m =
        inside(zone.polygon_m, point_m) ? 0.0 : distance_m(point_m, zone.polygon_m, true);
    if (away_m < nearest.away_m) nearest = {&zone, nullptr, away_m};
  }
  for (const DrawnLine& line : rules.lines()) {
    if (line.kind != LineKind::kWall) continue;
    const double away_m = distance_m(point_m, line.points_m, false);
    if (away_m < nearest.away_m) nearest = {nullptr, &line, away_m};
  }
  return nearest;
}

/// The path between two cells that breaks the fewest drawn rules, each counted by the length on
/// which it is broken.
class RuleBreaker {
 public:
  RuleBreaker(const FreeSpace& space, const ClosedCells& closed)
      : space_(space), closed_(closed), undrawn_(space.seen(), space.inflation()) {}

  /// All its cells from the first to the last; empty if there is none.
  std::vector<std::size_t> path(const Cell& from, const Cell& to) {
    const GridFrame& frame = space_.frame();
    cost_.assign(frame.size(), std::numeric_limits<double>::infinity());
    before_.assign(frame.size(), 0);
    const std::size_t goal = frame.index(to);
    const std::size_t start = frame.index(from);
    cost_[start] = 0.0;
    before_[start] = start;
    queue_.push({0.0, start});
    while (!queue_.empty()) {
      const auto [cost, index] = queue_.top();
      queue_.pop();
      if (index == goal) return back_from(goal);
      if (cost <= cost_[index]) visit_steps_from(index);
    }
    return {};
  }

  /// Whether a step is forbidden by the direction of a one-way zone.
  [[nodiscard]] bool against(std::size_t from, std::size_t to, std::size_t step) const {
    const DrivingRules& rules = space_.rules();
    if (!rules.guides()) return false;
    return ((rules.directions(from) & rules.directions(to)) >> step & 1U) == 0;
  }

 private:
  using Entry = std::pair<double, std::size_t>;

  [[nodiscard]] bool open(const Cell& cell) const {
    return (space_.passable(cell) || undrawn_.passable(cell)) && !closed_.forbids(cell);
  }

  void visit_steps_from(std::size_t index) {
    const GridFrame& frame = space_.frame();
    const Cell cell = frame.cell_at(index);
    for (std::size_t k = 0; k < kSteps.size(); ++k) {
      const Cell next{cell.column + kSteps[k].column, cell.row + kSteps[k].row};
      if (!open(next) || !open({next.column, cell.row}) || !open({cell.column, next.row})) continue;
      constexpr double kBroken = 1e4;  // no detour within a map is as long
      const std::size_t to = frame.index(next);
      const bool breaks = !space_.passable(to) || against(index, to, k);
      const double length = k < 4 ? 1.0 : std::numbers::sqrt2;
      const double cost = cost_[index] + length * (breaks ? kBroken : 1.0);
      if (cost >= cost_[to]) continue;
      cost_[to] = cost;
      before_[to] = index;
      queue_.push({cost, to});
    }
  }

  [[nodiscard]] std::vector<std::size_t> back_from(std::size_t index) const {
    std::vector<std::size_t> path = {index};
    while (before_[index] != index) path.push_back(index = before_[index]);
    std::reverse(path.begin(), path.end());
    return path;
  }

  const FreeSpace& space_;
  const ClosedCells& closed_;
  FreeSpace undrawn_;
  std::vector<double> cost_;
  std::vector<std::size_t> before_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

void add_once(std::vector<std::string>& items, std::string item) {
  if (std::find(items.begin(), items.end(), item) == items.end()) items.push_back(std::move(item));
}

}  // namespace

std::optional<std::string> drawn_obstruction(const FreeSpace& space,
                                             const Eigen::Vector2d& point_m) {
  const auto cell = space.frame().cell_of(point_m);
  if (!cell || space.passable(*cell)) return std::nullopt;
  const Nearest nearest = nearest_item(space.rules(), point_m);
  const double cell_m = space.frame().resolution_m;
  const double forbidden_m = space.inflation().forbidden_cells * cell_m;
  if (nearest.away_m > forbidden_m + cell_m) return std::nullopt;
  // An obstacle of the map that is nearer than the drawn item is the reason itself.
  if (space.grid().at(*cell) == CellState::kOccupied && space.seen().at(*cell) != CellState::kFree)
    return std::nullopt;
  if (nearest.zone != nullptr) {
    const std::string name = quoted(nearest.zone->name);
    if (nearest.away_m == 0.0) return "is in the no-go zone " + name;
    if (space.clearance_m(*cell) < nearest.away_m) return std::nullopt;
    return fmt::format("is {:.2f} m from the no-go zone {}: too near", nearest.away_m, name);
  }
  const std::string wall = text_of(*nearest.wall);
  if (nearest.away_m <= cell_m) return "is on " + wall;
  if (space.clearance_m(*cell) < nearest.away_m - cell_m) return std::nullopt;
  return fmt::format("is {:.2f} m from {}: too near", nearest.away_m, wall);
}

std::vector<std::string> drawn_items_between(const FreeSpace& space, const ClosedCells& closed,
                                             const Cell& from, const Cell& to) {
  const DrivingRules& rules = space.rules();
  if (rules.zones().empty() && rules.lines().empty()) return {};
  RuleBreaker breaker(space, closed);
  const std::vector<std::size_t> path = breaker.path(from, to);
  const GridFrame& frame = space.frame();
  std::vector<std::string> items;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Cell a = frame.cell_at(path[i - 1]);
    const Cell b = frame.cell_at(path[i]);
    const Eigen::Vector2d at_m = frame.center_m(b);
    if (!space.passable(b)) {
      const Nearest nearest = nearest_item(rules, at_m);
      if (nearest.zone != nullptr) add_once(items, quoted(nearest.zone->name));
      if (nearest.wall != nullptr) add_once(items, text_of(*nearest.wall));
    }
    const Cell step{b.column - a.column, b.row - a.row};
    const auto k = std::find(kSteps.begin(), kSteps.end(), step) - kSteps.begin();
    if (!breaker.against(path[i - 1], path[i], static_cast<std::size_t>(k))) continue;
    const Eigen::Vector2d direction_m = at_m - frame.center_m(a);
    for (const DrawnZone& zone : rules.zones()) {
      const bool touches =
          inside(zone.polygon_m, at_m) || inside(zone.polygon_m, frame.center_m(a));
      if (zone.kind == ZoneKind::kOneWay && touches && !may_drive(zone, direction_m)) {
        add_once(items, quoted(zone.name));
      }
    }
  }
  return items;
}

std::string in_the_way(const std::vector<std::string>& items) {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) text += i + 1 == items.size() ? " and " : ", ";
    text += items[i];
  }
  return text + (items.size() == 1 ? " is in the way" : " are in the way");
}

}  // namespace topogeo::planning
