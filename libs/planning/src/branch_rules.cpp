#include "branch_rules.hpp"

#include <algorithm>
#include <cmath>

#include "cell_line.hpp"

namespace topogeo::planning {

BranchRules::BranchRules(const GridFrame& frame, std::span<const DrawnZone> zones,
                         std::span<const DrawnLine> lines,
                         std::span<const Eigen::Vector2d> filled_m, double keep_off_m)
    : frame_(frame), rules_(frame, zones, lines) {
  std::vector<Cell> cells = rules_.no_go();
  for (const Eigen::Vector2d& point_m : filled_m) {
    if (const auto cell = frame.cell_of(point_m)) cells.push_back(*cell);
  }
  if (cells.empty() && !rules_.guides()) {
    frame_.reset();
    return;
  }
  places_.assign(frame.size(), Place::kOpen);
  const double reach = keep_off_m / frame.resolution_m;
  const auto steps = static_cast<std::int32_t>(reach);
  for (const Cell& cell : cells) {
    for (std::int32_t y = -steps; y <= steps; ++y) {
      for (std::int32_t x = -steps; x <= steps; ++x) {
        const Cell near{cell.column + x, cell.row + y};
        if (x * x + y * y > reach * reach || !frame.contains(near)) continue;
        places_[frame.index(near)] = Place::kShut;
      }
    }
  }
  for (const Cell& cell : cells) places_[frame.index(cell)] = Place::kFilled;
}

BranchRules::Place BranchRules::at(const Eigen::Vector2d& point_m) const {
  if (!frame_) return Place::kOpen;
  const auto cell = frame_->cell_of(point_m);
  return cell ? places_[frame_->index(*cell)] : Place::kOpen;
}

bool BranchRules::shut(const Eigen::Vector2d& point_m) const {
  return at(point_m) != Place::kOpen;
}

bool BranchRules::filled(const Eigen::Vector2d& point_m) const {
  return at(point_m) == Place::kFilled;
}

BranchRules::Passage BranchRules::along(const Eigen::Vector2d& a_m,
                                        const Eigen::Vector2d& b_m) const {
  Passage passage;
  if (!frame_) return passage;
  const Eigen::Vector2d a = frame_->in_cells(a_m);
  const Eigen::Vector2d b = frame_->in_cells(b_m);
  const auto usual = static_cast<double>(rules_.usual_slowness());
  double slowness = 0.0;
  double cells = 0.0;
  visit_line(a, b, [&](const Cell& cell) {
    cells += 1.0;
    if (!frame_->contains(cell)) {
      slowness += usual;
      return true;
    }
    const std::size_t index = frame_->index(cell);
    if (places_[index] != Place::kOpen) {
      passage.forth = passage.back = false;
      return false;
    }
    slowness += rules_.guides() ? static_cast<double>(rules_.slowness(index)) : usual;
    if (rules_.guides() && a != b) {
      passage.forth = passage.forth && rules_.allows(index, b - a);
      passage.back = passage.back && rules_.allows(index, a - b);
    }
    return true;
  });
  passage.slowness = slowness / cells;
  return passage;
}

}  // namespace topogeo::planning
