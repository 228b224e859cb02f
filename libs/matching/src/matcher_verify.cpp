// Matcher::verify: checks the statements of a result about its poses.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "topogeo/matching/match.hpp"
#include "topogeo/matching/matcher.hpp"
#include "topogeo/matching/place_field.hpp"

#include "genetic_search.hpp"
#include "match_evidence.hpp"
#include "matcher_buffers.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

bool sane(const Pose2& T) {
  constexpr double kFarthest_m = 2e6;  // twice the largest in a task
  return std::fabs(T.x_m) <= kFarthest_m && std::fabs(T.y_m) <= kFarthest_m &&
         std::fabs(T.theta_rad) <= std::numbers::pi;
}

std::string differs(const std::string& name, double stated, double right) {
  char text[160];
  std::snprintf(text, sizeof text, " is %.17g, expected %.17g", stated, right);
  return name + text;
}

std::string nth(std::size_t i) {
  return "solution " + std::to_string(i + 1);
}

// Faults that show before anything is computed from the poses.
std::string faults_of_form(const MatchTask& task, const MatchResult& result) {
  if (result.task_id != task.task_id) return "the task_id is that of another task";
  if (result.seed != task.seed) return "the seed is not that of the task";
  if (result.solutions.empty()) return "there is no solution";
  if (result.solutions.size() > task.solutions_wanted) {
    return std::to_string(result.solutions.size()) + " solutions, expected at most " +
           std::to_string(task.solutions_wanted);
  }
  const std::uint64_t searches = task.genetic.finer_resolution_m > 0.0 ? 1 + kRefined : 1;
  const std::uint64_t most =
      searches * std::uint64_t{task.genetic.individuals} * std::uint64_t{task.genetic.generations};
  if (result.evaluations < task.genetic.individuals || result.evaluations > most) {
    return std::to_string(result.evaluations) + " evaluations, expected " +
           std::to_string(task.genetic.individuals) + " to " + std::to_string(most);
  }
  for (std::size_t i = 0; i < result.solutions.size(); ++i) {
    const Pose2& T = result.solutions[i].T_reference_query;
    if (!sane(T) || !in_search_space(task, T)) return nth(i) + " is outside of the search space";
    for (std::size_t k = 0; k < i; ++k) {
      if (same_solution(task, T, result.solutions[k].T_reference_query)) {
        return nth(k) + " and " + nth(i) + " are the same";
      }
    }
  }
  if (!sane(result.T_reference_query)) return "the refined pose is invalid";
  if (!sane(result.second.T_reference_query)) return "the pose of the second is invalid";
  return {};
}

// The first difference between the stated and the recomputed result.
std::string difference(const MatchResult& stated, const MatchResult& right) {
  for (std::size_t i = 0; i < right.solutions.size(); ++i) {
    if (!identical(stated.solutions[i].fitness, right.solutions[i].fitness)) {
      return differs("the fitness of " + nth(i), stated.solutions[i].fitness,
                     right.solutions[i].fitness);
    }
  }
  if (!identical(stated.T_reference_query, right.T_reference_query)) {
    return "there is a refined pose though no solution fits";
  }
  if (!identical(stated.second.T_reference_query, right.second.T_reference_query)) {
    return "there is a second pose without a fitness";
  }
  struct Number {
    const char* name;
    double stated;
    double right;
  };
  for (const Number& number :
       {Number{"the fitness", stated.fitness, right.fitness},
        Number{"the fitness of the second", stated.second.fitness, right.second.fitness},
        Number{"the overlap", stated.overlap, right.overlap},
        Number{"the share of inliers", stated.inliers, right.inliers},
        Number{"the share of violations", stated.violations, right.violations},
        Number{"the residual", stated.residual_rms_m, right.residual_rms_m},
        Number{"the scan fitness", stated.scan_fitness, right.scan_fitness},
        Number{"the topological fitness", stated.topological_fitness, right.topological_fitness}}) {
    if (!identical(number.stated, number.right))
      return differs(number.name, number.stated, number.right);
  }
  for (int i = 0; i < 9; ++i) {
    if (!identical(stated.covariance(i), right.covariance(i))) {
      return differs("element " + std::to_string(i) + " of the covariance", stated.covariance(i),
                     right.covariance(i));
    }
  }
  if (stated.status != right.status) return "the status is wrong";
  if (stated.verdict != right.verdict) return "the verdict is wrong";
  if (stated.reason != right.reason) return "the reason is wrong";
  return {};
}

// Faults in the choice of poses: solve() would not choose these, even if the numbers are right.
std::string faults_of_choice(const MatchResult& right) {
  for (std::size_t i = 1; i < right.solutions.size(); ++i) {
    if (right.solutions[i].fitness > right.solutions[i - 1].fitness) {
      return nth(i) + " is better than " + nth(i - 1);
    }
  }
  // The second is the best other pose by the maps, so with odometry it may be the better one.
  if (right.second.fitness == 0.0) return {};
  if (same_place(right.second.T_reference_query, right.T_reference_query)) {
    return "the second is the same as the best";
  }
  return {};
}

}  // namespace

std::string Matcher::verify(const MatchTask& task, const MatchResult& result) {
  if (task.places) return field(*task.places).verify(*task.places, result.solutions);
  check(task);
  const MatchFeatures& query = *features(task.query_map_id, task.query_hash, task.evidence);
  const Reference& against = reference(task);
  std::string fault = faults_of_form(task, result);
  if (!fault.empty()) return fault;
  buffers_->forms.bind(against, query, task);
  MatchResult right = result;
  add_evidence({task, against, query, buffers_->forms}, right);
  fault = difference(result, right);
  return fault.empty() ? faults_of_choice(right) : fault;
}

}  // namespace topogeo::localization
