#include "matching_accuracy.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/LU>

#include "topogeo/matching/refinement.hpp"
#include "topogeo/support/cpu_time.hpp"

namespace topogeo::bench {
namespace {

using geometry::Pose2;
using localization::FitnessForm;
using localization::MatchResult;
using localization::MatchTask;
using localization::UncertainPose;

constexpr double kWorse_m = 0.05;
constexpr double kWorse_rad = std::numbers::pi / 180.0;
constexpr double kDegrees = 180.0 / std::numbers::pi;

/// One method for a relative pose, over all pairs.
struct Row {
  std::string name;
  std::vector<double> error_m;
  std::vector<double> error_rad;
  std::size_t better = 0;
  std::size_t worse = 0;
  std::uint64_t evaluations = 0;
  double ms = 0.0;
  bool matches = false;  ///< evaluations and time are valid

  void add(const PoseError& error, const PoseError& odometry) {
    error_m.push_back(error.m);
    error_rad.push_back(error.rad);
    better += error.together() < odometry.together() ? 1 : 0;
    worse += error.m > odometry.m + kWorse_m || error.rad > odometry.rad + kWorse_rad ? 1 : 0;
  }
};

double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void print(std::FILE* out, const std::string& log, std::size_t apart, const Row& row) {
  const std::size_t pairs = row.error_m.size();
  if (pairs == 0) return;
  const double per_pair = 1.0 / static_cast<double>(pairs);
  std::fprintf(out, "| %s | i,i+%zu | %s | %zu | %.3f | %.2f | ", log.c_str(), apart,
               row.name.c_str(), pairs, median_of(row.error_m),
               kDegrees * median_of(row.error_rad));
  if (row.name == "odometry") {
    std::fputs("- | - | ", out);
  } else {
    std::fprintf(out, "%.3f | %.3f | ", per_pair * static_cast<double>(row.better),
                 per_pair * static_cast<double>(row.worse));
  }
  if (row.matches) {
    std::fprintf(out, "%.0f | %.2f |\n", per_pair * static_cast<double>(row.evaluations),
                 per_pair * row.ms);
  } else {
    std::fputs("- | - |\n", out);
  }
}

/// The two rows of a form of the fitness: the result of the genetic search, and the refined one.
struct Form {
  FitnessForm form;
  Row found;
  Row refined;
};

struct Pair {
  std::size_t earlier;
  std::size_t later;
  Pose2 T_earlier_later;  // true
};

std::vector<Pair> pairs_of(const MatchingRun& run, std::size_t apart, std::size_t most_pairs) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i + apart < run.size(); ++i) {
    if (const auto T = run.truth(i, i + apart)) pairs.push_back({i, i + apart, *T});
  }
  if (pairs.size() <= most_pairs) return pairs;
  std::vector<Pair> some;
  for (std::size_t k = 0; k < most_pairs; ++k) some.push_back(pairs[k * pairs.size() / most_pairs]);
  return some;
}

/// The localizer's task for a new stop: it is the reference, and the scan tracker's relative pose
/// is an initial individual.
MatchTask task_for(const MatchingRun& run, const Pair& pair, const UncertainPose& odometry) {
  MatchTask task = run.task(pair.later, pair.earlier,
                            {geometry::inverse(odometry.T_a_b),
                             geometry::inverse_covariance(odometry.T_a_b, odometry.covariance)});
  task.initial_individuals.push_back(geometry::inverse(run.tracked(pair.earlier, pair.later)));
  return task;
}

/// The later stop in the frame of the earlier one, by combined fitness, refined.
Pose2 matched(MatchingRun& run, const Pair& pair) {
  UncertainPose expected = run.odometry(pair.earlier, pair.later);
  expected.T_a_b = run.tracked(pair.earlier, pair.later);
  return geometry::inverse(run.matcher().solve(task_for(run, pair, expected)).T_reference_query);
}

/// Milliseconds of the refinement of a result's solutions, which is part of solving.
double refinement_ms(MatchingRun& run, const Pair& pair, const MatchTask& task,
                     const MatchResult& result) {
  const localization::Reference reference = localization::make_reference(run.features(pair.later));
  const localization::PosePrior prior{task.T_reference_query, task.covariance.inverse()};
  const double start_s = support::process_cpu_s();
  for (std::size_t i = 0; i < std::min<std::size_t>(3, result.solutions.size()); ++i) {
    localization::refine(reference, run.features(pair.earlier),
                         result.solutions[i].T_reference_query, prior);
  }
  return 1e3 * (support::process_cpu_s() - start_s);
}

}  // namespace

void print_accuracy_header(std::FILE* out) {
  std::fputs(
      "| log | pairs | by | number | median error m | median error deg | better than odometry | "
      "worse by > 5 cm or 1 deg | evaluations | ms |\n|---|---|---|---|---|---|---|---|---|---|\n",
      out);
}

void print_accuracy(std::FILE* out, MatchingRun& run, std::size_t apart, std::size_t most_pairs) {
  Row odometry_row{"odometry", {}, {}};
  Row tracked_row{"scan tracker", {}, {}};
  Row accepted_row{"combined, refined, accepted only", {}, {}};
  std::array<Form, 3> forms{
      Form{FitnessForm::kPrinted, {"printed", {}, {}}, {"printed, refined", {}, {}}},
      Form{FitnessForm::kTopological, {"topological", {}, {}}, {"topological, refined", {}, {}}},
      Form{FitnessForm::kCombined, {"combined", {}, {}}, {"combined, refined", {}, {}}}};
  for (const Pair& pair : pairs_of(run, apart, most_pairs)) {
    const UncertainPose odometry = run.odometry(pair.earlier, pair.later);
    const PoseError odometry_error = error_of(odometry.T_a_b, pair.T_earlier_later);
    odometry_row.add(odometry_error, odometry_error);
    tracked_row.add(error_of(run.tracked(pair.earlier, pair.later), pair.T_earlier_later),
                    odometry_error);
    MatchTask task = task_for(run, pair, odometry);
    const auto add = [&](Row& row, const Pose2& T_later_earlier) {
      row.add(error_of(geometry::inverse(T_later_earlier), pair.T_earlier_later), odometry_error);
    };
    run.matcher().solve(task);  // fills the matcher's cache for the reference
    for (Form& form : forms) {
      task.fitness_form = form.form;
      const double start_s = support::process_cpu_s();
      const MatchResult result = run.matcher().solve(task);
      const double ms = 1e3 * (support::process_cpu_s() - start_s);
      const bool solved = result.status == localization::MatchStatus::kSolved;
      // Without a solution, odometry remains.
      add(form.found, solved ? result.solutions.front().T_reference_query : task.T_reference_query);
      add(form.refined, solved ? result.T_reference_query : task.T_reference_query);
      form.found.evaluations += result.evaluations;
      form.refined.evaluations += result.evaluations;
      form.refined.ms += ms;
      form.found.ms += std::max(0.0, ms - refinement_ms(run, pair, task, result));
      form.found.matches = form.refined.matches = true;
      if (form.form == FitnessForm::kCombined &&
          result.verdict == localization::Verdict::kAccepted) {
        add(accepted_row, result.T_reference_query);
      }
    }
  }
  print(out, run.name(), apart, odometry_row);
  print(out, run.name(), apart, tracked_row);
  for (const Form& form : forms) {
    print(out, run.name(), apart, form.found);
    print(out, run.name(), apart, form.refined);
  }
  print(out, run.name(), apart, accepted_row);
  std::fflush(out);
}

void print_closure_header(std::FILE* out) {
  std::fputs(
      "| log | number | closing of i, i+1, i+2: median m | median deg | i,i+2 against the "
      "reference: median m | median deg |\n|---|---|---|---|---|---|\n",
      out);
}

void print_closure(std::FILE* out, MatchingRun& run, std::size_t most) {
  Row closure;
  Row against_reference;
  for (const Pair& pair : pairs_of(run, 2, most)) {
    const std::size_t i = pair.earlier;
    const Pose2 around = matched(run, {i, i + 1, {}}) * matched(run, {i + 1, i + 2, {}});
    const Pose2 direct = matched(run, pair);
    closure.add(error_of(around, direct), {});
    against_reference.add(error_of(direct, pair.T_earlier_later), {});
  }
  if (closure.error_m.empty()) return;
  std::fprintf(out, "| %s | %zu | %.4f | %.2f | %.4f | %.2f |\n", run.name().c_str(),
               closure.error_m.size(), median_of(closure.error_m),
               kDegrees * median_of(closure.error_rad), median_of(against_reference.error_m),
               kDegrees * median_of(against_reference.error_rad));
  std::fflush(out);
}

}  // namespace topogeo::bench
