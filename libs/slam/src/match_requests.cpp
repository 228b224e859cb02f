#include "topogeo/slam/match_requests.hpp"

#include <utility>

#include "topogeo/support/seed.hpp"

namespace topogeo::localization {

MatchRequests::MatchRequests(const LocalizerConfig& config, MatchPool& pool)
    : config_(config), pool_(pool) {}

void MatchRequests::add_map(std::shared_ptr<const topomap::LocalMap> map) {
  maps_[map->id] = {topomap::content_hash(*map), map->robot_id};
  pool_.add_map(std::move(map));
}

MatchTask MatchRequests::make(std::uint32_t reference_id, std::uint32_t query_id,
                              const UncertainPose& T_reference_query) {
  const KnownMap& reference = maps_.at(reference_id);
  const KnownMap& query = maps_.at(query_id);
  MatchTask task = match_task(config_, T_reference_query);
  task.task_id = next_task_++;
  task.reference_map_id = reference_id;
  task.query_map_id = query_id;
  task.reference_hash = reference.hash;
  task.query_hash = query.hash;
  task.seed = support::derive_seed(config_.seed, reference.robot_id,
                                   {reference_id, query_id, next_match_++});
  return task;
}

MatchTask MatchRequests::place_task(const std::shared_ptr<const PlaceQuestion>& question,
                                    std::uint32_t query_id) {
  MatchTask task;
  task.task_id = next_task_++;
  task.query_map_id = query_id;
  task.query_hash = maps_.at(query_id).hash;
  task.places = question;
  return task;
}

std::vector<MatchSolution> MatchRequests::ask(
    std::span<const std::shared_ptr<const PlaceQuestion>> questions, std::uint32_t query_id) {
  if (questions.empty()) return {};
  std::vector<MatchTask> tasks;
  for (const auto& question : questions) tasks.push_back(place_task(question, query_id));
  std::vector<MatchSolution> places;
  for (const MatchResult& result : pool_.match(tasks)) {
    places.insert(places.end(), result.solutions.begin(), result.solutions.end());
  }
  return places;
}

std::vector<MatchResult> MatchRequests::run(std::span<const MatchTask> tasks) {
  if (tasks.empty()) return {};
  std::vector<MatchResult> results = pool_.match(tasks);
  for (const MatchResult& result : results) {
    ++counts_.tasks;
    counts_.evaluations += result.evaluations;
    ++counts_.reasons[static_cast<std::size_t>(result.reason)];
  }
  return results;
}

}  // namespace topogeo::localization
