#include "topogeo/matching/matcher.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>

#include <Eigen/LU>

#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/place_field.hpp"
#include "topogeo/matching/refinement.hpp"

#include "fitness_combined.hpp"
#include "match_evidence.hpp"
#include "match_rivals.hpp"
#include "matcher_buffers.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

// Rates rivals by the evidence that refines a match; without refinement, by the requested form.
double rating(const MatchContext& context, const Pose2& T) {
  const geometry::SinCos heading = geometry::sincos(T.theta_rad);
  return context.task.evidence == MatchEvidence::kFitness
             ? context.forms.of_maps(T, heading)
             : context.forms.combined().of_maps(T, heading);
}

Alignment align_by_evidence(const MatchContext& context, const Pose2& T, const PosePrior& prior) {
  if (context.task.evidence == MatchEvidence::kFitness) return {T, 0, false};
  return align(context.reference, context.query, T, prior);
}

// Refines the `starts` and takes the one with the largest fitness, aligned again with weak_prior(),
// as the result's pose. Its second is the best other pose by the maps alone, without odometry.
void choose(const MatchContext& context, const std::vector<MatchSolution>& starts,
            MatchResult& result) {
  const PosePrior prior{context.task.T_reference_query, context.task.covariance.inverse()};
  std::array<MatchSolution, kRefined> refined;
  std::size_t best = 0;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const Alignment aligned = align_by_evidence(context, starts[i].T_reference_query, prior);
    refined[i] = {aligned.T_reference_query, context.forms.chosen()(aligned.T_reference_query)};
    if (refined[i].fitness > refined[best].fitness) best = i;
  }
  result.T_reference_query = refined[best].T_reference_query;
  const Alignment released =
      align_by_evidence(context, result.T_reference_query, weak_prior(prior));
  if (released.converged && same_place(released.T_reference_query, result.T_reference_query)) {
    result.T_reference_query = released.T_reference_query;
  }
  if (context.task.evidence != MatchEvidence::kFitness) {
    result.second = strongest_rival(context, result.T_reference_query);
  }
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const Pose2& T = refined[i].T_reference_query;
    if (same_place(T, result.T_reference_query)) continue;
    const double fitness = rating(context, T);
    if (fitness > result.second.fitness) result.second = {T, fitness};
  }
  if (result.second.fitness <= 0.0) return;
  // It is rated like every other solution, by the requested form, which may give 0.
  result.second.fitness = context.forms.chosen()(result.second.T_reference_query);
  if (result.second.fitness <= 0.0) result.second = {};
}

// The second search (Thesis, 7.3.1.2): around a solution, one cell of the first search to each
// side, as far as that lies in the search space.
MatchTask finer_task(const MatchTask& task, const Pose2& T_solution) {
  MatchTask finer = task;
  finer.initial_individuals.clear();
  const Eigen::Vector3d cell(task.genetic.resolution_m, task.genetic.resolution_m,
                             task.genetic.resolution_rad);
  const Eigen::Vector3d off = geometry::difference(T_solution, task.T_reference_query);
  const Eigen::Vector3d low = (off - cell).cwiseMax(-task.half_width);
  const Eigen::Vector3d high = (off + cell).cwiseMin(task.half_width);
  const Eigen::Vector3d middle = 0.5 * (low + high);
  finer.T_reference_query = {task.T_reference_query.x_m + middle.x(),
                             task.T_reference_query.y_m + middle.y(),
                             geometry::wrap_angle(task.T_reference_query.theta_rad + middle.z())};
  finer.half_width = 0.5 * (high - low);
  finer.genetic.resolution_m = task.genetic.finer_resolution_m;
  finer.genetic.resolution_rad = task.genetic.finer_resolution_rad;
  return finer;
}

}  // namespace

void Matcher::add_map(const topomap::LocalMap& map) {
  KnownMap& known = maps_[map.id];
  known = {topomap::content_hash(map),
           std::make_shared<const MatchFeatures>(extract_features(map)),
           {},
           {}};
  known.branches.branches = map.branches;
  known.branches.T_robot_laser = map.T_robot_laser;
}

bool Matcher::has_map(std::uint32_t id, std::uint64_t hash) const {
  const auto found = maps_.find(id);
  return found != maps_.end() && found->second.hash == hash;
}

Matcher::KnownMap& Matcher::known(std::uint32_t id, std::uint64_t hash) {
  const auto found = maps_.find(id);
  if (found == maps_.end())
    throw std::out_of_range("local map " + std::to_string(id) + " is not known");
  if (found->second.hash != hash) {
    throw std::out_of_range("local map " + std::to_string(id) +
                            " differs from the one of the task");
  }
  return found->second;
}

const std::shared_ptr<const MatchFeatures>& Matcher::features(std::uint32_t id, std::uint64_t hash,
                                                              MatchEvidence evidence) {
  KnownMap& map = known(id, hash);
  if (evidence == MatchEvidence::kScan) return map.features;
  if (!map.by_branches) {
    map.by_branches = std::make_shared<const MatchFeatures>(
        with_walls(*map.features, walls_of_branches(map.branches)));
  }
  return map.by_branches;
}

const Reference& Matcher::reference(const MatchTask& task) {
  const std::uint32_t id = task.reference_map_id;
  const std::uint64_t hash = task.reference_hash;
  const bool by_scan = task.evidence == MatchEvidence::kScan;
  const std::shared_ptr<const MatchFeatures>& seen = features(id, hash, task.evidence);
  const auto found = std::find_if(references_.begin(), references_.end(), [&](const auto& cached) {
    return cached.id == id && cached.hash == hash && cached.by_scan == by_scan;
  });
  if (found != references_.end()) {
    references_.splice(references_.begin(), references_, found);
  } else {
    // Reuses the memory of the least recently used one, which is lost if this throws.
    std::list<CachedReference> made;
    if (references_.size() < kKeptReferences) {
      made.emplace_back();
    } else {
      made.splice(made.begin(), references_, std::prev(references_.end()));
    }
    remake_reference(seen, made.front().reference);
    made.front().id = id;
    made.front().hash = hash;
    made.front().by_scan = by_scan;
    references_.splice(references_.begin(), made);
  }
  return references_.front().reference;
}

bool Matcher::has_field(std::uint64_t hash) const {
  return field_ != nullptr && field_->hash() == hash;
}

const PlaceField& Matcher::field(const PlaceQuestion& question) const {
  if (!has_field(question.field_hash))
    throw std::out_of_range("the place field of the map is not known");
  return *field_;
}

Matcher::Matcher() : buffers_(std::make_unique<Buffers>()) {}
Matcher::Matcher(Matcher&&) noexcept = default;
Matcher& Matcher::operator=(Matcher&&) noexcept = default;
Matcher::~Matcher() = default;

MatchResult Matcher::solve(const MatchTask& task) {
  if (task.places) {
    MatchResult result;
    result.task_id = task.task_id;
    result.status = MatchStatus::kSolved;
    result.solutions = field(*task.places).answer(*task.places);
    return result;
  }
  check(task);
  const MatchFeatures& query = *features(task.query_map_id, task.query_hash, task.evidence);
  const Reference& against = reference(task);
  buffers_->forms.bind(against, query, task);

  MatchResult result;
  result.evaluations = buffers_->search.run(
      task, buffers_->forms.chosen(), buffers_->hypotheses.find(task, *against.features, query));
  result.solutions.reserve(task.solutions_wanted);
  buffers_->search.best_distinct(
      task.solutions_wanted,
      [&](const Pose2& a, const Pose2& b) { return same_solution(task, a, b); }, result.solutions);
  const MatchContext context{task, against, query, buffers_->forms};
  if (!result.solutions.empty() && result.solutions.front().fitness > 0.0) {
    buffers_->search.best_distinct(kRefined, same_place, buffers_->starts);
    if (task.genetic.finer_resolution_m > 0.0) result.evaluations += search_finer(task);
    choose(context, buffers_->starts, result);
  }
  add_evidence(context, result);
  return result;
}

std::uint32_t Matcher::search_finer(const MatchTask& task) {
  std::uint32_t evaluations = 0;
  std::vector<MatchSolution> best;
  for (MatchSolution& start : buffers_->starts) {
    evaluations += buffers_->search.run(finer_task(task, start.T_reference_query),
                                        buffers_->forms.chosen(), {});
    buffers_->search.best_distinct(1, same_place, best);
    if (!best.empty() && best.front().fitness > start.fitness) start = best.front();
  }
  return evaluations;
}

std::vector<MatchResult> InProcessPool::match(std::span<const MatchTask> tasks) {
  std::vector<MatchResult> results;
  results.reserve(tasks.size());
  for (const MatchTask& task : tasks) results.push_back(matcher_.solve(task));
  return results;
}

}  // namespace topogeo::localization
