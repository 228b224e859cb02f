// Outlines of zones, for people who merge and split rooms.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/zones.hpp"

namespace topogeo::planning {

/// The outer outlines of the union of some zones, map frame, counter-clockwise; one for each
/// connected part. A line (map frame) splits a part where it crosses it from side to side, extended
/// up to 0.5 m beyond its ends. If that splits nothing, ends up to 1.5 m before another zone,
/// without a wall between, are extended to it. Cells without a zone count if they are up to 0.3 m
/// beside the zones, so that the outlines reach the walls. Simplified within a cell as long as they
/// have at most 256 corners. Leaves out parts of less than four cells and ignores unknown ids.
std::vector<std::vector<Eigen::Vector2d>> outlines_of(
    const GridFrame& frame, const ZoneMap& zones, std::span<const ZoneId> ids,
    const std::optional<std::pair<Eigen::Vector2d, Eigen::Vector2d>>& cut_m = std::nullopt);

}  // namespace topogeo::planning
