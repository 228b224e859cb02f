// The error of a trajectory against a reference, in the usual measures of this field: poses paired
// by time, their distance after the best rigid alignment, and the error of relative poses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "topogeo/storage/relations.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::pipeline {

/// Mean error of relative poses.
struct RelativeError {
  double mean_m = 0.0;
  double mean_rad = 0.0;
  std::size_t pairs = 0;
};

struct TrajectoryError {
  std::size_t pairs = 0;     ///< poses compared
  double matched = 0.0;      ///< share of the reference that has a partner, (0, 1]
  double path_m = 0.0;       ///< path length between the compared poses, by the reference
  double rms_m = 0.0;        ///< root of the mean squared distance after alignment
  double largest_m = 0.0;    ///< largest such distance
  double heading_rad = 0.0;  ///< mean absolute difference of headings after alignment
  RelativeError local;       ///< from each pose to the next
  /// Between poses within 1.5 m of each other by the reference although more than 20 m of its path
  /// lie between them, at most 2000 such pairs: small in a map that closes its loops. Empty without
  /// such pairs.
  std::optional<RelativeError> loop;
  double end_m = 0.0;  ///< distance of the last poses if the first ones coincide
};

/// Pairs each pose of `reference` with the pose of `estimate` nearest in time, if they are at most
/// `max_apart_ns` apart, and aligns the estimate rigidly (no scaling) by least squares of the
/// distances. Both in any order, each in its own frame. Throws std::invalid_argument if fewer than
/// three poses pair, naming the times that both cover.
TrajectoryError trajectory_error(std::span<const topomap::StampedPose> estimate,
                                 std::span<const topomap::StampedPose> reference,
                                 std::int64_t max_apart_ns = 50'000'000);

/// Errors of relations: mean and standard deviation.
struct RelationSpread {
  double mean_m = 0.0;
  double deviation_m = 0.0;
  double mean_rad = 0.0;
  double deviation_rad = 0.0;
  std::size_t pairs = 0;
};

struct RelationsError {
  std::size_t given = 0;              ///< relations, usable or not
  std::optional<RelationSpread> all;  ///< of relations with both times in the estimate
  std::optional<RelationSpread> far;  ///< of those with times over 30 s apart
};

/// Each end of a relation is the pose nearest in time, if that is at most `max_apart_ns` away.
RelationsError relations_error(std::span<const topomap::StampedPose> estimate,
                               std::span<const storage::Relation> relations,
                               std::int64_t max_apart_ns = 1'000'000);

}  // namespace topogeo::pipeline
