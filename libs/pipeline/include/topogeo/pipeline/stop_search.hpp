// One search for the relative pose of two stops with all its intermediate results, for inspection.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::pipeline {

/// Components of the fitness of a pose, each in [0, 1].
struct FitnessParts {
  double scan = 0.0;         ///< points on points
  double topological = 0.0;  ///< nodes and branches
  double prior = 0.0;        ///< likelihood by odometry, at most 1
};

struct StopSearch {
  localization::MatchTask task;
  localization::ErrorEllipse ellipse;  ///< of the prediction, search_probability
  localization::MatchResult result;
  std::vector<FitnessParts> solutions;  ///< of result.solutions
  FitnessParts refined;
};

/// Throws std::invalid_argument unless both are below `stops` and different.
void check_stops(std::size_t stops, std::size_t reference, std::size_t query);

/// Odometry from stop `reference` to stop `query` of a drive, through all stops in between; also
/// backwards. Throws like check_stops(), and std::invalid_argument if no odometry connects them.
localization::UncertainPose predict_by_odometry(std::span<const topomap::LocalMap> stops,
                                                std::size_t reference, std::size_t query,
                                                const localization::OdometryNoise& noise);

/// Searches the stop `query` around its prediction in the frame of the stop `reference`, like a
/// localizer with this configuration. Throws like predict_by_odometry() and Matcher::solve().
StopSearch search_stop(const topomap::LocalMap& reference, const topomap::LocalMap& query,
                       const localization::UncertainPose& T_reference_query,
                       const localization::LocalizerConfig& config);

}  // namespace topogeo::pipeline
