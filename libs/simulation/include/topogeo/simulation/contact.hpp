// Free path of a disc that moves through a world until it touches something.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "topogeo/geometry/footprint.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::simulation {

struct FreePath {
  double distance_m = 0.0;  ///< at most the requested length
  /// The point of the surface that the disc touches at the end; nothing if the whole path is free.
  std::optional<Eigen::Vector2d> contact_m{};
};

/// The path of a disc from `from_m` along `direction` (of unit length), at most `length_m` (>= 0).
/// Columns and people are solid. A surface that the disc already touches or overlaps (a door has
/// shut on it) stops the disc at once if the move brings it nearer, and is ignored otherwise.
/// Changing parts are ignored: see scene_at.
FreePath free_path(const world::World& scene, const Eigen::Vector2d& from_m,
                   const Eigen::Vector2d& direction, double length_m, double radius_m);

/// The point nearest to the disc's centre among surfaces that overlap the disc by more than 0.1 mm;
/// nothing if there is none.
std::optional<Eigen::Vector2d> overlap_m(const world::World& scene, const Eigen::Vector2d& center_m,
                                         double radius_m);

/// A place where a wall, column or person reaches into an outline at a pose; nothing if none does.
std::optional<Eigen::Vector2d> overlap_m(const world::World& scene, const geometry::Pose2& pose,
                                         const geometry::Footprint& footprint);

}  // namespace topogeo::simulation
