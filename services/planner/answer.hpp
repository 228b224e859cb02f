// The planner's answer to a goal.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "topogeo/msg/planning.h"
#include "topogeo/planning/goal_planner.hpp"
#include "topogeo/service/conversions.hpp"

namespace topogeo::planner {

/// The goal; or nothing, and the refusing answer, for a goal that the navigator refuses as well.
std::optional<service::Goal> goal_from(const msg::Goal& message, msg::Route& refusal);

/// The answer to a goal at a position, node or place, without header, goal_id and versions. Missing
/// maps are empty in `maps`, as is a missing `pose`; `blocked_m` are points (map frame) on
/// obstacles that are not on the map; points outside of the map are ignored. Every error is a
/// status of the answer. Throws std::invalid_argument when the route does not fit a message.
msg::Route answer(const msg::Goal& goal, const planning::PlanningMaps& maps,
                  const std::optional<service::LivePose>& pose,
                  std::span<const Eigen::Vector2d> blocked_m,
                  const planning::GoalPlannerConfig& config = {});

}  // namespace topogeo::planner
