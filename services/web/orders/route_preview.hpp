// Previews the planner's route before a goal is given.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "topogeo/navigation/follower_config.hpp"
#include "topogeo/planning/goal_planner.hpp"

#include "server/web_types.hpp"

namespace topogeo::web {

/// Route from `from_m` through all `goals_m` in order (map frame; at least one): length, time at
/// the speeds of `follower`, smallest clearance; or the reason why there is none. Throws
/// std::invalid_argument like `check` of the settings.
Answer preview_route(const planning::PlanningMaps& maps, const Eigen::Vector2d& from_m,
                     const std::vector<Eigen::Vector2d>& goals_m,
                     const planning::GoalPlannerConfig& config,
                     const navigation::FollowerConfig& follower);

/// Seconds for a route along its points: one acceleration, straight lines at full speed, and the
/// turns at the corners.
double drive_time_s(const std::vector<Eigen::Vector2d>& points_m,
                    const navigation::FollowerConfig& follower);

}  // namespace topogeo::web
