#include <algorithm>

#include "topogeo/slam/match_requests.hpp"
#include "topogeo/slam/pose_graph.hpp"

namespace topogeo::localization {

MatchTask match_task(const LocalizerConfig& config, const UncertainPose& T_reference_query) {
  MatchTask task;
  task.T_reference_query = T_reference_query.T_a_b;
  task.covariance = T_reference_query.covariance;
  const Eigen::Vector3d half = search_half_width(
      T_reference_query.covariance, config.search_probability, config.search_heading_sigmas);
  // A refinement starts within a cell of the search around a good pose. Without one, only the
  // uncertainty itself keeps the pose near its odometry, as in the Thesis (6.25-6.28).
  const double cells = config.evidence == MatchEvidence::kFitness ? 0.0 : 1.0;
  const Eigen::Vector3d smallest(config.genetic.resolution_m, config.genetic.resolution_m,
                                 config.genetic.resolution_rad);
  task.half_width = half.cwiseMax(cells * smallest);
  task.half_width.x() = std::min(task.half_width.x(), config.largest_half_width_m);
  task.half_width.y() = std::min(task.half_width.y(), config.largest_half_width_m);
  task.half_width.z() = std::min(task.half_width.z(), config.largest_half_width_rad);
  task.genetic = config.genetic;
  task.fitness_form = config.fitness_form;
  task.evidence = config.evidence;
  task.solutions_wanted = config.solutions_wanted;
  task.gate = config.gate;
  return task;
}

bool searchable(const LocalizerConfig& config, const UncertainPose& T_reference_query) {
  const Eigen::Vector3d half = search_half_width(
      T_reference_query.covariance, config.search_probability, config.search_heading_sigmas);
  return half.x() <= config.largest_half_width_m && half.y() <= config.largest_half_width_m &&
         half.z() <= config.largest_half_width_rad;
}

double largest_searchable_cost(const LocalizerConfig& config) {
  const Eigen::Vector3d unit = search_half_width(
      Eigen::Matrix3d::Identity(), config.search_probability, config.search_heading_sigmas);
  const Eigen::Vector3d sigma(config.largest_half_width_m / unit.x(),
                              config.largest_half_width_m / unit.y(),
                              config.largest_half_width_rad / unit.z());
  return PoseGraph::path_cost(sigma.cwiseAbs2().asDiagonal());
}

}  // namespace topogeo::localization
