// Outlines of zones, for people who join and part rooms.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/zones.hpp"

namespace topogeo::planning {

/// The outer outlines of some zones joined, map frame, counter-clockwise; one for each part that
/// hangs together, parted by a line (map frame) where it leads from one side of a part to the
/// other, up to 0.5 m beyond its ends; where that parts nothing, ends that lie up to 1.5 m before
/// another zone, with no wall between, go on to it. Cells that are in no zone count up to 0.3 m
/// beside those that are, so that the outlines reach the walls. Straightened by no more than a
/// cell, as long as they have at most 256 corners. Parts of less than four cells are left out. Ids
/// that are not there count nothing.
std::vector<std::vector<Eigen::Vector2d>> outlines_of(
    const GridFrame& frame, const ZoneMap& zones, std::span<const ZoneId> ids,
    const std::optional<std::pair<Eigen::Vector2d, Eigen::Vector2d>>& cut_m = std::nullopt);

}  // namespace topogeo::planning
