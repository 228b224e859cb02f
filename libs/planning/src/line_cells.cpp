#include "line_cells.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "cell_line.hpp"

namespace topogeo::planning {
namespace {

using Segment = std::pair<Eigen::Vector2d, Eigen::Vector2d>;

/// The part of a segment in the grid extended by one cell (Liang and Barsky 1984), coordinates in
/// cells. It limits the cost of a wall that is drawn endlessly long.
std::optional<Segment> clipped(const GridFrame& frame, const Segment& segment) {
  const Eigen::Vector2d low(-1.0, -1.0);
  const Eigen::Vector2d high(frame.columns + 1.0, frame.rows + 1.0);
  const Eigen::Vector2d along = segment.second - segment.first;
  double begin = 0.0;
  double end = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    const double from = segment.first[axis];
    if (along[axis] == 0.0) {
      if (from < low[axis] || from > high[axis]) return std::nullopt;
      continue;
    }
    double enters = (low[axis] - from) / along[axis];
    double leaves = (high[axis] - from) / along[axis];
    if (enters > leaves) std::swap(enters, leaves);
    begin = std::max(begin, enters);
    end = std::min(end, leaves);
  }
  if (begin > end) return std::nullopt;
  // Ends inside keep every bit.
  return Segment{begin > 0.0 ? Eigen::Vector2d(segment.first + begin * along) : segment.first,
                 end < 1.0 ? Eigen::Vector2d(segment.first + end * along) : segment.second};
}

void add_line(const GridFrame& frame, const Segment& in_cells, std::vector<Cell>& cells) {
  const auto inside = clipped(frame, in_cells);
  if (!inside) return;
  visit_line(inside->first, inside->second, [&](const Cell& cell) {
    if (frame.contains(cell)) cells.push_back(cell);
    return true;
  });
}

/// Adds cells beside the segment, up to the thickness of walls.
void add_opening(const GridFrame& frame, const Segment& in_cells, std::vector<Cell>& cells) {
  const auto& [a, b] = in_cells;
  const double length = (b - a).norm();
  if (length == 0.0) return;
  const Eigen::Vector2d along = (b - a) / length;
  const double reach = kOpeningReach_m / frame.resolution_m;
  const Eigen::Vector2d last(frame.columns - 1.0, frame.rows - 1.0);
  const Eigen::Vector2d more = Eigen::Vector2d::Constant(reach + 1.0);
  const Eigen::Vector2d low = (a.cwiseMin(b) - more).cwiseMax(Eigen::Vector2d::Zero());
  const Eigen::Vector2d high = (a.cwiseMax(b) + more).cwiseMin(last);
  for (double row = std::floor(low.y()); row <= high.y(); ++row) {
    for (double column = std::floor(low.x()); column <= high.x(); ++column) {
      const Eigen::Vector2d from_a = Eigen::Vector2d(column + 0.5, row + 0.5) - a;
      const double share = from_a.dot(along);
      const double away = std::fabs(along.x() * from_a.y() - along.y() * from_a.x());
      if (share >= 0.0 && share <= length && away <= reach) {
        cells.push_back({static_cast<std::int32_t>(column), static_cast<std::int32_t>(row)});
      }
    }
  }
}

}  // namespace

LineCells cells_of_lines(const GridFrame& frame, std::span<const DrawnLine> lines) {
  LineCells cells;
  for (const DrawnLine& line : lines) {
    for (std::size_t i = 0; i + 1 < line.points_m.size(); ++i) {
      const Segment segment(frame.in_cells(line.points_m[i]), frame.in_cells(line.points_m[i + 1]));
      if (line.kind == LineKind::kWall) {
        add_line(frame, segment, cells.walls);
      } else {
        add_opening(frame, segment, cells.open);
      }
    }
  }
  if (cells.open.empty() || cells.walls.empty()) return cells;
  std::vector<bool> open(frame.size(), false);
  for (const Cell& cell : cells.open) open[frame.index(cell)] = true;
  std::erase_if(cells.walls, [&](const Cell& cell) { return open[frame.index(cell)]; });
  return cells;
}

std::vector<Cell> cells_across(const GridFrame& frame, const Eigen::Vector2d& a_m,
                               const Eigen::Vector2d& b_m, double beyond_m) {
  std::vector<Cell> cells;
  const Eigen::Vector2d more_m = (b_m - a_m).normalized() * beyond_m;
  add_line(frame, {frame.in_cells(a_m - more_m), frame.in_cells(b_m + more_m)}, cells);
  return cells;
}

}  // namespace topogeo::planning
