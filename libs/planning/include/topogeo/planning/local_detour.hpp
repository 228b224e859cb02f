// A detour round unmapped obstacles on the route: planned on a window of the grid around the robot,
// with the obstacles that its sensors see now, back to the route behind them.
//
// Own method; MACONDO, III names such routines without a description (docs/algorithms.md, "Driving
// and collision guard").
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/detour_config.hpp"
#include "topogeo/planning/free_space.hpp"

namespace topogeo::planning {

enum class DetourStatus : std::uint8_t {
  kClear = 0,    ///< nothing blocks the route within the window
  kFound = 1,    ///< the cells go round
  kBlocked = 2,  ///< no detour within the window
  kLost = 3,     ///< the robot is outside of the grid or has no passable cell near it
};

/// Short text for logs and messages.
std::string_view describe(DetourStatus status);

struct Detour {
  DetourStatus status = DetourStatus::kLost;
  std::string reason;       ///< one line for people; empty if clear or found; then nothing below is
                            ///< empty
  std::vector<Cell> cells;  ///< from the robot's cell over the detour to the end of the route
  std::vector<Eigen::Vector2d> points_m;  ///< straightened, from the robot to `goal_m`
  std::size_t rejoins = 0;  ///< index in the old route of the cell at which it rejoins
};

/// `route`: cells of a planned route; `goal_m`: its exact end; `obstacles_m`: seen points, map
/// frame. Cells within the inflation of the space around these are also forbidden. Throws
/// std::invalid_argument for an empty route, points that are not finite and a configuration out of
/// range.
Detour plan_detour(const FreeSpace& space, std::span<const Cell> route,
                   const Eigen::Vector2d& robot_m, const Eigen::Vector2d& goal_m,
                   std::span<const Eigen::Vector2d> obstacles_m, const DetourConfig& config = {});

}  // namespace topogeo::planning
