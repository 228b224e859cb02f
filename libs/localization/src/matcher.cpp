#include "topogeo/localization/matcher.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/LU>

#include "topogeo/localization/genetic_search.hpp"
#include "topogeo/localization/refinement.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

constexpr std::size_t kCachedReferences = 4;
constexpr std::size_t kRefined = 3;  // solutions that are refined before the winner is chosen

constexpr std::uint32_t kMostSolutions = 40;

void require(bool condition, const MatchTask& task, const std::string& complaint) {
  if (condition) return;
  throw std::invalid_argument("match task " + std::to_string(task.task_id) + ": " + complaint);
}

// A task may come from another machine, so nothing of it is taken on trust.
void check(const MatchTask& task) {
  const Pose2& T = task.T_reference_query;
  require(std::isfinite(T.x_m) && std::isfinite(T.y_m) && std::isfinite(T.theta_rad), task,
          "the predicted pose is not finite");
  const Eigen::Matrix3d& c = task.covariance;
  require(c.allFinite() && c(0, 0) > 0.0 && c.topLeftCorner<2, 2>().determinant() > 0.0 &&
              c.determinant() > 0.0,
          task, "the covariance is not positive definite");
  require(task.half_width.allFinite() && task.half_width.minCoeff() > 0.0, task,
          "the search space is empty");
  require(task.genetic.resolution_m > 0.0 && task.genetic.resolution_rad > 0.0, task,
          "the resolution must be greater than 0");
  require(task.solutions_wanted >= 1 && task.solutions_wanted <= kMostSolutions, task,
          std::to_string(task.solutions_wanted) + " solutions wanted, allowed are 1 to " +
              std::to_string(kMostSolutions));
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
  result.task_id = task.task_id;
  SearchOutcome outcome = genetic_search(task, fitness);
  result.solutions = std::move(outcome.solutions);
  result.evaluations = outcome.evaluations;
  if (result.solutions.empty() || result.solutions.front().fitness <= 0.0) return result;

  const PosePrior prior{task.T_reference_query, task.covariance.inverse()};
  Refinement best;
  double best_fitness = -1.0;
  const std::size_t count = std::min(kRefined, result.solutions.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Refinement refined = refine(against, query, result.solutions[i].T_reference_query, prior);
    const double value = fitness(refined.T_reference_query);
    const bool distinct = best_fitness >= 0.0 && (refined.T_reference_query.position_m() -
                                                  best.T_reference_query.position_m())
                                                         .squaredNorm() > 0.09;
    if (value > best_fitness) {
      if (distinct) result.second_fitness = std::max(result.second_fitness, best_fitness);
      best = refined;
      best_fitness = value;
    } else if (distinct) {
      result.second_fitness = std::max(result.second_fitness, value);
    }
  }
  result.T_reference_query = best.T_reference_query;
  result.fitness = best_fitness;
  result.information = best.information;
  result.overlap = best.overlap;
  result.inliers = best.inliers;
  result.violations = best.violations;
  result.residual_rms_m = best.residual_rms_m;
  result.scan_fitness = fitness.scan(best.T_reference_query);
  result.topological_fitness = fitness.topological(best.T_reference_query);
  result.status = best.overlap > 0.0 ? MatchStatus::kSolved : MatchStatus::kNothingInCommon;
  return result;
}

std::vector<MatchResult> InProcessPool::match(std::span<const MatchTask> tasks) {
  std::vector<MatchResult> results;
  results.reserve(tasks.size());
  for (const MatchTask& task : tasks) results.push_back(matcher_.solve(task));
  return results;
}

}  // namespace topogeo::localization
