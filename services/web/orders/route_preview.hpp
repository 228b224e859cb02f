// Previews the planner's route before a goal is given.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/navigation/navigator_config.hpp"
#include "topogeo/planning/goal_planner.hpp"

#include "server/web_types.hpp"

namespace topogeo::web {

/// Route from the robot through all `goals_m` in order (map frame; at least one): length, time at
/// the speeds of `navigator` and of slow zones, smallest clearance; or the reason why there is
/// none. Throws std::invalid_argument like `check` of the settings.
Answer preview_route(const planning::PlanningMaps& maps, const geometry::Pose2& T_map_robot,
                     const std::vector<Eigen::Vector2d>& goals_m,
                     const planning::GoalPlannerConfig& config,
                     const navigation::NavigatorConfig& navigator);

}  // namespace topogeo::web
