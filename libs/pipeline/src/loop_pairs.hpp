// Pairs of poses at which a trajectory comes back to a place.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::pipeline {

using IndexPair = std::pair<std::size_t, std::size_t>;

/// The pairs of TrajectoryError::loop of a path, at most 2000: exactly those that the evaluation
/// tool of this field's logs (a Python program) takes, so that the figures can be compared.
std::vector<IndexPair> loop_pairs(std::span<const geometry::Pose2> path);

/// Puts them into the order that `random.Random(0).shuffle` of Python gives a list.
void shuffle_as_python(std::vector<IndexPair>& pairs);

}  // namespace topogeo::pipeline
