#include "route_floor.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace topogeo::navigation {
namespace {

using planning::Cell;
using planning::GridFrame;
using planning::PlannedOn;

class FloorOpener {
 public:
  explicit FloorOpener(const planning::FreeSpace& space)
      : frame_(space.frame()),
        reach_m_((space.inflation().forbidden_cells + 1.0) * space.frame().resolution_m) {}

  void open(const RoutePlan& route) {
    for (std::size_t k = 0; k < route.parts.size(); ++k) {
      if (route.parts[k].on == PlannedOn::kGrid) continue;
      const std::size_t end =
          k + 1 < route.parts.size() ? route.parts[k + 1].first_point : route.points_m.size() - 1;
      for (std::size_t i = route.parts[k].first_point; i < end; ++i) {
        open_line(route, i, route.parts[k].on != PlannedOn::kOffBranch);
      }
    }
  }

  [[nodiscard]] const std::vector<Cell>& freed() const { return freed_; }
  [[nodiscard]] const std::vector<Cell>& entered() const { return entered_; }

 private:
  void open_line(const RoutePlan& route, std::size_t i, bool frees) {
    constexpr double kStepsPerCell = 10.0;  // skips no relevant corner of a cell
    const Eigen::Vector2d& from_m = route.points_m[i];
    const Eigen::Vector2d line_m = route.points_m[i + 1] - from_m;
    const int steps = static_cast<int>(kStepsPerCell * line_m.norm() / frame_.resolution_m) + 1;
    std::optional<Cell> last;
    for (int step = 0; step <= steps; ++step) {
      const double share = static_cast<double>(step) / steps;
      const Eigen::Vector2d at_m = from_m + share * line_m;
      const auto cell = frame_.cell_of(at_m);
      if (!cell || last == cell) continue;
      // A diagonal step needs both neighbouring cells.
      if (last) {
        enter({last->column, cell->row});
        enter({cell->column, last->row});
      }
      enter(*cell);
      last = cell;
      if (!frees) continue;
      free_around(at_m, route.clearances_m[i] +
                            share * (route.clearances_m[i + 1] - route.clearances_m[i]));
    }
  }

  void enter(const Cell& cell) {
    if (frame_.contains(cell)) entered_.push_back(cell);
  }

  // Does not free the walls on the circle itself.
  void free_around(const Eigen::Vector2d& at_m, double clearance_m) {
    const double radius_m = std::min(clearance_m - frame_.resolution_m, reach_m_);
    if (radius_m <= 0.0) return;
    const Cell middle = frame_.cell_of(at_m).value();
    const auto reach = static_cast<std::int32_t>(std::ceil(radius_m / frame_.resolution_m));
    for (std::int32_t row = middle.row - reach; row <= middle.row + reach; ++row) {
      for (std::int32_t column = middle.column - reach; column <= middle.column + reach; ++column) {
        const Cell cell{column, row};
        if (!frame_.contains(cell)) continue;
        if ((frame_.center_m(cell) - at_m).norm() <= radius_m) freed_.push_back(cell);
      }
    }
  }

  const GridFrame& frame_;
  double reach_m_;
  std::vector<Cell> freed_;
  std::vector<Cell> entered_;
};

}  // namespace

bool on_branches(const RoutePlan& route) {
  return route.clearances_m.size() == route.points_m.size() &&
         std::ranges::any_of(route.parts, [](const planning::RoutePart& part) {
           return part.on == PlannedOn::kBranch || part.on == PlannedOn::kVirtualBranch;
         });
}

std::shared_ptr<const planning::FreeSpace> floor_of(const RoutePlan& route,
                                                    const planning::FreeSpace* space) {
  if (space == nullptr) {
    constexpr double kMargin_m = 6.0;  // more than a detour leaves the route
    return std::make_shared<const planning::FreeSpace>(planning::OccupancyGrid(
        planning::frame_around(route.points_m, kMargin_m), planning::CellState::kFree));
  }
  FloorOpener opener(*space);
  opener.open(route);
  return std::make_shared<const planning::FreeSpace>(
      space->opened(opener.freed(), opener.entered()));
}

}  // namespace topogeo::navigation
