// Pairs of poses at which a trajectory returns to a place.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::pipeline {

using IndexPair = std::pair<std::size_t, std::size_t>;

/// The pairs for TrajectoryError::loop of a path, at most 2000: exactly those of this field's
/// evaluation tool for logs (a Python program), so that the figures can be compared.
std::vector<IndexPair> loop_pairs(std::span<const geometry::Pose2> path);

/// Shuffles them like `random.Random(0).shuffle` of Python.
void shuffle_as_python(std::vector<IndexPair>& pairs);

}  // namespace topogeo::pipeline
