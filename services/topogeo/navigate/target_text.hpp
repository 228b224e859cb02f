// Places as people write them on the command line.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "topogeo/planning/hybrid_planner.hpp"

namespace topogeo::cli {

/// "1.5,-2": metres in the map frame; nothing for any other text.
std::optional<Eigen::Vector2d> point_of(std::string_view text);

/// The same for a flag that requires a point: throws service::UsageError naming it.
Eigen::Vector2d point_for(std::string_view flag, std::string_view text);

/// X,Y, #NODE or the name of a place.
planning::Target target_of(const std::string& text);

/// Why there is no route, with the nearest place that can be reached if the goal cannot.
std::string no_route_text(const planning::HybridRoute& route);

}  // namespace topogeo::cli
