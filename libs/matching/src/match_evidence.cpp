#include "match_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/LU>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/matching/match_gate.hpp"
#include "topogeo/matching/refinement.hpp"

#include "fitness_combined.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

// Limits on tasks from other machines, not settings: they protect the worker.
constexpr std::uint32_t kFewestIndividuals = 4;
constexpr std::uint32_t kMostIndividuals = 10'000;
constexpr std::uint64_t kMostEvaluations = 1'000'000;  // a second of one core, 32 MB
constexpr std::uint32_t kMostSolutions = 40;
constexpr double kUnreachable_m = 1e6;
constexpr double kMostTurned_rad = 1e4;
constexpr double kWidest_m = 1000.0;
constexpr double kWidest_rad = 4.0;  // a little over half a turn to both sides

class Checker {
 public:
  explicit Checker(const MatchTask& task) : task_(task) {}

  // A NaN is outside every range.
  void range(const char* name, double value, double low, double high) const {
    if (value >= low && value <= high) return;
    char text[160];
    std::snprintf(text, sizeof text, "%s is %g, expected %g to %g", name, value, low, high);
    fail(text);
  }
  void pose(const char* name, const Pose2& T) const {
    if (std::fabs(T.x_m) <= kUnreachable_m && std::fabs(T.y_m) <= kUnreachable_m &&
        std::fabs(T.theta_rad) <= kMostTurned_rad) {
      return;
    }
    char text[200];
    std::snprintf(text, sizeof text, "%s is (%g m, %g m, %g rad), expected at most %g m and %g rad",
                  name, T.x_m, T.y_m, T.theta_rad, kUnreachable_m, kMostTurned_rad);
    fail(text);
  }
  [[noreturn]] void fail(const std::string& complaint) const {
    throw std::invalid_argument("match task " + std::to_string(task_.task_id) + ": " + complaint);
  }

 private:
  const MatchTask& task_;
};

void check_genetic(const Checker& checker, const GeneticParameters& g) {
  checker.range("individuals", g.individuals, kFewestIndividuals, kMostIndividuals);
  const std::uint64_t most_generations = kMostEvaluations / g.individuals;
  checker.range("generations", g.generations, 1.0, static_cast<double>(most_generations));
  checker.range("crossover_rate", g.crossover_rate, 0.0, 1.0);
  checker.range("mutation_rate", g.mutation_rate, 0.0, 0.5);
  checker.range("elite", g.elite, 1.0, g.individuals - 1.0);
  checker.range("branch_hypotheses", g.branch_hypotheses, 0.0, kMostIndividuals);
  checker.range("resolution_m", g.resolution_m, 1e-6, 10.0);
  checker.range("resolution_rad", g.resolution_rad, 1e-6, 4.0);
  if (g.finer_resolution_m == 0.0) return;
  checker.range("finer_resolution_m", g.finer_resolution_m, 1e-6, 10.0);
  checker.range("finer_resolution_rad", g.finer_resolution_rad, 1e-6, 4.0);
}

void check_gate(const Checker& checker, const GateConfig& gate) {
  for (const auto& [name, value] : {std::pair{"smallest_overlap", gate.smallest_overlap},
                                    std::pair{"smallest_inliers", gate.smallest_inliers},
                                    std::pair{"largest_doubt", gate.largest_doubt},
                                    std::pair{"doubt_per_search_m", gate.doubt_per_search_m},
                                    std::pair{"largest_mahalanobis2", gate.largest_mahalanobis2},
                                    std::pair{"largest_ambiguity", gate.largest_ambiguity}}) {
    checker.range(name, value, 0.0, 1e9);
  }
}

}  // namespace

void check(const MatchTask& task) {
  const Checker checker(task);
  checker.pose("predicted pose", task.T_reference_query);
  for (const Pose2& T : task.initial_individuals) checker.pose("initial individual", T);
  const Eigen::Matrix3d& c = task.covariance;
  const bool positive_definite = c.allFinite() && c(0, 0) > 0.0 &&
                                 c.topLeftCorner<2, 2>().determinant() > 0.0 &&
                                 c.determinant() > 0.0 && c.inverse().allFinite();
  if (!positive_definite) checker.fail("the covariance is not positive definite");
  checker.range("half_width.x", task.half_width.x(), 1e-6, kWidest_m);
  checker.range("half_width.y", task.half_width.y(), 1e-6, kWidest_m);
  checker.range("half_width.theta", task.half_width.z(), 1e-6, kWidest_rad);
  check_genetic(checker, task.genetic);
  check_gate(checker, task.gate);
  checker.range("fitness_form", static_cast<double>(task.fitness_form), 0.0,
                static_cast<double>(FitnessForm::kTopologicalWeighted));
  if (!has_fitness_form(task.fitness_form)) {
    checker.fail(std::string("the fitness form '") + to_string(task.fitness_form) +
                 "' is not built into this program");
  }
  checker.range("evidence", static_cast<double>(task.evidence), 0.0,
                static_cast<double>(MatchEvidence::kFitness));
  checker.range("solutions_wanted", task.solutions_wanted, 1.0, kMostSolutions);
}

void add_evidence(const MatchContext& context, MatchResult& result) {
  const auto& [task, reference, query, forms] = context;
  const Fitness& fitness = forms.chosen();
  MatchResult stated;  // starts empty, so that no field can be forgotten
  stated.task_id = task.task_id;
  stated.seed = task.seed;
  stated.evaluations = result.evaluations;
  stated.solutions = std::move(result.solutions);
  for (MatchSolution& solution : stated.solutions) {
    solution.fitness = fitness(solution.T_reference_query);
  }
  if (!stated.solutions.empty() && stated.solutions.front().fitness > 0.0) {
    const Pose2& T = result.T_reference_query;
    const PoseEvidence evidence = evidence_at(reference, query, T);
    stated.T_reference_query = T;
    stated.fitness = fitness(T);
    if (result.second.fitness > 0.0) {
      stated.second = {result.second.T_reference_query, fitness(result.second.T_reference_query)};
    }
    stated.overlap = evidence.overlap;
    stated.inliers = evidence.inliers;
    stated.violations = evidence.violations;
    stated.residual_rms_m = evidence.residual_rms_m;
    stated.scan_fitness = task.evidence == MatchEvidence::kFitness
                              ? forms.of_maps(T, geometry::sincos(T.theta_rad))
                              : forms.combined().scan()(T);
    stated.topological_fitness = forms.combined().topological()(T);
    const bool in_common =
        task.evidence == MatchEvidence::kFitness ? stated.fitness > 0.0 : evidence.overlap > 0.0;
    stated.status = in_common ? MatchStatus::kSolved : MatchStatus::kNothingInCommon;
    if (task.evidence == MatchEvidence::kFitness) {
      stated.covariance = task.covariance;
    } else if (!evidence.information.isZero(0.0)) {
      const bool by_scan = task.evidence == MatchEvidence::kScan;
      stated.covariance = match_covariance(
          by_scan ? evidence.information
                  : less_normal_errors(evidence.information, kBranchNormalSigma_rad),
          doubt(stated));
    }
  }
  const Judgement judgement = judge(task, stated);
  stated.verdict = judgement.verdict;
  stated.reason = judgement.reason;
  result = std::move(stated);
}

}  // namespace topogeo::localization
