// Hybrid A* over positions and headings.
#pragma once

#include <optional>
#include <vector>

#include "outline_field.hpp"
#include "outline_moves.hpp"

namespace topogeo::planning {

/// The moves from a pose to a goal; nothing if the outline fits along no path.
std::optional<std::vector<OutlineMove>> search_moves(const OutlineField& field,
                                                     const OutlineMoves& moves,
                                                     const OutlineConfig& config,
                                                     const geometry::Pose2& start,
                                                     const PoseGoal& goal);

/// The same way with fewer moves, where straight links between its poses cost no more.
std::vector<OutlineMove> shortened(const OutlineMoves& moves, const geometry::Pose2& start,
                                   const PoseGoal& goal, std::vector<OutlineMove> path);

}  // namespace topogeo::planning
