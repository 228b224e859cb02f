#include "topogeo/thesis/thesis_matching.hpp"

#include <utility>

#include <Eigen/LU>

#include "topogeo/matching/match_gate.hpp"
#include "topogeo/matching/refinement.hpp"

namespace topogeo::localization {

using geometry::Pose2;

void ThesisMatching::add(const ThesisMap& map) {
  requests_.add_map(map.stop(map.size() - 1).map);
}

std::vector<ThesisMatch> ThesisMatching::match(const ThesisMap& map,
                                               std::span<const ThesisNeighbour> with,
                                               std::uint32_t solutions) {
  const auto stop = static_cast<std::uint32_t>(map.size() - 1);
  std::vector<MatchTask> tasks;
  for (const ThesisNeighbour& neighbour : with) {
    MatchTask task = requests_.make(stop, neighbour.id, neighbour.T_new_earlier);
    task.solutions_wanted = solutions;
    const auto known = last_solutions_.find(neighbour.id);
    if (known != last_solutions_.end()) {
      const Pose2 T_now_before = geometry::inverse(map.stop(stop).T_previous_this.T_a_b);
      for (const MatchSolution& solution : known->second) {
        task.initial_individuals.push_back(T_now_before * solution.T_reference_query);
      }
    }
    tasks.push_back(std::move(task));
  }
  std::vector<MatchResult> results = requests_.run(tasks);
  std::vector<ThesisMatch> matches;
  for (std::size_t i = 0; i < results.size(); ++i) {
    ThesisMatch& found = matches.emplace_back();
    found.earlier = tasks[i].query_map_id;
    found.result = std::move(results[i]);
    if (found.result.status == MatchStatus::kSolved) {
      // ThesisMap has no odometry edges besides its matches, so the match includes the prior.
      if (tasks[i].evidence != MatchEvidence::kFitness && !found.result.covariance.isZero(0.0)) {
        found.result.T_reference_query =
            with_prior(found.result.T_reference_query, data_covariance(found.result),
                       {tasks[i].T_reference_query, tasks[i].covariance.inverse()});
      }
      found.T_earlier_new = {
          geometry::inverse(found.result.T_reference_query),
          geometry::inverse_covariance(found.result.T_reference_query, found.result.covariance)};
    }
  }
  return matches;
}

void ThesisMatching::remember(std::span<const ThesisMatch> matches) {
  last_solutions_.clear();
  for (const ThesisMatch& match : matches) last_solutions_[match.earlier] = match.result.solutions;
}

}  // namespace topogeo::localization
