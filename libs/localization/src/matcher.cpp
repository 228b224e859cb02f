#include "topogeo/localization/matcher.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/LU>

#include "topogeo/localization/genetic_search.hpp"
#include "topogeo/localization/refinement.hpp"

#include "match_evidence.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

constexpr std::size_t kCachedReferences = 4;
constexpr std::size_t kRefined = 3;  // solutions that are refined before the winner is chosen

// Refines the best solutions and takes the one with the largest fitness as the result's pose, and
// the best of those that lie elsewhere as its second.
void choose(const MatchContext& context, MatchResult& result) {
  const PosePrior prior{context.task.T_reference_query, context.task.covariance.inverse()};
  std::array<MatchSolution, kRefined> refined;
  const std::size_t count = std::min(kRefined, result.solutions.size());
  std::size_t best = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Pose2 T =
        align(context.reference, context.query, result.solutions[i].T_reference_query, prior)
            .T_reference_query;
    refined[i] = {T, context.fitness(T)};
    if (refined[i].fitness > refined[best].fitness) best = i;
  }
  result.T_reference_query = refined[best].T_reference_query;
  for (std::size_t i = 0; i < count; ++i) {
    const double apart_m2 =
        (refined[i].T_reference_query.position_m() - result.T_reference_query.position_m())
            .squaredNorm();
    if (apart_m2 > kSecondApart_m * kSecondApart_m && refined[i].fitness > result.second.fitness) {
      result.second = refined[i];
    }
  }
}

}  // namespace

void Matcher::add_map(const topomap::LocalMap& map) {
  maps_[map.id] = {topomap::content_hash(map), extract_features(map)};
}

bool Matcher::has_map(std::uint32_t id, std::uint64_t hash) const {
  const auto found = maps_.find(id);
  return found != maps_.end() && found->second.hash == hash;
}

const Matcher::KnownMap& Matcher::known(std::uint32_t id, std::uint64_t hash) const {
  const auto found = maps_.find(id);
  if (found == maps_.end())
    throw std::out_of_range("local map " + std::to_string(id) + " is not known");
  if (found->second.hash != hash) {
    throw std::out_of_range("local map " + std::to_string(id) +
                            " has another content than the task means");
  }
  return found->second;
}

const Reference& Matcher::reference(std::uint32_t id, std::uint64_t hash) {
  const KnownMap& map = known(id, hash);
  const auto found = std::find_if(references_.begin(), references_.end(), [&](const auto& cached) {
    return cached.id == id && cached.hash == hash;
  });
  if (found != references_.end()) {
    references_.splice(references_.begin(), references_, found);
  } else {
    references_.push_front({id, hash, make_reference(map.features)});
    if (references_.size() > kCachedReferences) references_.pop_back();
  }
  return references_.front().reference;
}

MatchResult Matcher::solve(const MatchTask& task) {
  check(task);
  const MatchFeatures& query = known(task.query_map_id, task.query_hash).features;
  const Reference& against = reference(task.reference_map_id, task.reference_hash);
  const Fitness fitness(against, query, task);

  MatchResult result;
  SearchOutcome outcome = genetic_search(task, fitness);
  result.solutions = std::move(outcome.solutions);
  result.evaluations = outcome.evaluations;
  const MatchContext context{task, against, query, fitness};
  if (!result.solutions.empty() && result.solutions.front().fitness > 0.0) {
    choose(context, result);
  }
  add_evidence(context, result);
  return result;
}

std::vector<MatchResult> InProcessPool::match(std::span<const MatchTask> tasks) {
  std::vector<MatchResult> results;
  results.reserve(tasks.size());
  for (const MatchTask& task : tasks) results.push_back(matcher_.solve(task));
  return results;
}

}  // namespace topogeo::localization
