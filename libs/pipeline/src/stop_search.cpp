#include "topogeo/pipeline/stop_search.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "topogeo/matching/fitness_forms.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/matcher.hpp"
#include "topogeo/slam/match_requests.hpp"
#include "topogeo/support/hash.hpp"

namespace topogeo::pipeline {

using localization::UncertainPose;

namespace {

// The features of a map that a match by this evidence uses.
localization::MatchFeatures features_for(const topomap::LocalMap& map,
                                         localization::MatchEvidence evidence) {
  localization::MatchFeatures features = localization::extract_features(map);
  if (evidence == localization::MatchEvidence::kScan) return features;
  return with_walls(features, localization::walls_of_branches(map));
}

}  // namespace

void check_stops(std::size_t stops, std::size_t reference, std::size_t query) {
  for (const std::size_t stop : {reference, query}) {
    if (stop < stops) continue;
    throw std::invalid_argument("stop " + std::to_string(stop) + " does not exist: the map has " +
                                std::to_string(stops) + " stops");
  }
  if (reference == query) throw std::invalid_argument("a stop cannot be matched with itself");
}

UncertainPose predict_by_odometry(std::span<const topomap::LocalMap> stops, std::size_t reference,
                                  std::size_t query, const localization::OdometryNoise& noise) {
  check_stops(stops.size(), reference, query);
  UncertainPose T_first_last;
  const std::size_t first = std::min(reference, query);
  for (std::size_t i = first + 1; i <= std::max(reference, query); ++i) {
    if (!topomap::has_odometry_between(stops[i - 1], stops[i])) {
      throw std::invalid_argument("no odometry connects stop " + std::to_string(i - 1) +
                                  " to stop " + std::to_string(i));
    }
    T_first_last =
        compose(T_first_last, odometry_between_stops(stops[i - 1].T_odom_robot, stops[i], noise));
  }
  return reference < query ? T_first_last : inverse(T_first_last);
}

StopSearch search_stop(const topomap::LocalMap& reference, const topomap::LocalMap& query,
                       const UncertainPose& T_reference_query,
                       const localization::LocalizerConfig& config) {
  StopSearch search;
  UncertainPose predicted = T_reference_query;
  predicted.covariance = localization::invertible(predicted.covariance);
  search.task = localization::match_task(config, predicted);
  search.task.reference_map_id = reference.id;
  search.task.query_map_id = query.id;
  search.task.reference_hash = topomap::content_hash(reference);
  search.task.query_hash = topomap::content_hash(query);
  support::Fnv1a seed;
  seed.add(config.seed);
  seed.add(search.task.reference_hash);
  seed.add(search.task.query_hash);
  search.task.seed = seed.value();
  search.ellipse = localization::error_ellipse(predicted.covariance.topLeftCorner<2, 2>(),
                                               localization::ellipse_k2(config.search_probability));
  localization::Matcher matcher;
  matcher.add_map(reference);
  matcher.add_map(query);
  search.result = matcher.solve(search.task);

  const localization::Reference features =
      localization::make_reference(features_for(reference, config.evidence));
  const localization::MatchFeatures query_features = features_for(query, config.evidence);
  const localization::FitnessForms fitness(features, query_features, search.task);
  const auto parts_at = [&](const geometry::Pose2& T) {
    const localization::FitnessForms::Parts parts = fitness.parts(T);
    return FitnessParts{parts.scan, parts.topological, parts.prior};
  };
  for (const localization::MatchSolution& solution : search.result.solutions) {
    search.solutions.push_back(parts_at(solution.T_reference_query));
  }
  search.refined = parts_at(search.result.T_reference_query);
  return search;
}

}  // namespace topogeo::pipeline
