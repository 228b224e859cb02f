// The part of Localizer that chooses what to compare and judges the answers.
#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "topogeo/localization/mapping/localizer.hpp"
#include "topogeo/localization/matching/expected_overlap.hpp"
#include "topogeo/localization/matching/refinement.hpp"
#include "topogeo/support/seed.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

constexpr double kFarthestCompared_m = 20.0;  // stops further apart are not compared

}  // namespace

MatchTask match_task(const LocalizerConfig& config, const UncertainPose& T_reference_query) {
  MatchTask task;
  task.T_reference_query = T_reference_query.T_a_b;
  task.covariance = T_reference_query.covariance;
  const Eigen::Vector3d half = search_half_width(
      T_reference_query.covariance, config.search_probability, config.search_heading_sigmas);
  const Eigen::Vector3d smallest(config.genetic.resolution_m, config.genetic.resolution_m,
                                 config.genetic.resolution_rad);
  task.half_width = half.cwiseMax(smallest);
  task.half_width.x() = std::min(task.half_width.x(), config.largest_half_width_m);
  task.half_width.y() = std::min(task.half_width.y(), config.largest_half_width_m);
  task.half_width.z() = std::min(task.half_width.z(), config.largest_half_width_rad);
  task.genetic = config.genetic;
  task.fitness_form = config.fitness_form;
  task.solutions_wanted = config.solutions_wanted;
  task.gate = config.gate;
  return task;
}

std::vector<Localizer::Candidate> Localizer::candidates(std::uint32_t stop,
                                                        std::span<const UncertainPose> relative,
                                                        bool recent, std::uint32_t count) const {
  std::vector<Candidate> found;
  const std::uint32_t middle = first_recent(stop);
  const Pose2& T_map_robot = graph_.poses()[stop];
  for (std::uint32_t i = recent ? middle : 0; i < (recent ? stop : middle); ++i) {
    // In this order, because most stops of a long log are far away.
    const Eigen::Vector2d apart_m = graph_.poses()[i].position_m() - T_map_robot.position_m();
    // The stop just before is worth a task in any case, however bad odometry is by now.
    const bool always = recent && i + 1 == stop;
    if (!always && (apart_m.squaredNorm() > kFarthestCompared_m * kFarthestCompared_m ||
                    !searchable(relative[i]) || !worth_comparing(i, stop, relative[i].T_a_b))) {
      continue;
    }
    if (always) {
      found.push_back({i, 2.0});
      continue;
    }
    const double least = config_.smallest_expected_overlap;
    const double overlap =
        expected_overlap(stops_[stop].profile, stops_[i].outline, relative[i], least);
    if (overlap >= least) found.push_back({i, overlap});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.overlap > b.overlap; });
  // Older places next to each other say nearly the same: take the best, then some that lie apart.
  std::vector<Candidate> chosen;
  for (const Candidate& candidate : found) {
    if (chosen.size() == count) break;
    const bool neighbour =
        !recent && std::any_of(chosen.begin(), chosen.end(), [&](const Candidate& c) {
          return c.id + 1 == candidate.id || candidate.id + 1 == c.id;
        });
    if (!neighbour) chosen.push_back(candidate);
  }
  return chosen;
}

// A rejected pair gets another chance once an optimisation has changed what is expected of it.
bool Localizer::worth_comparing(std::uint32_t earlier, std::uint32_t later,
                                const Pose2& T_later_earlier) const {
  const auto found = stops_[later].compared.find(earlier);
  if (found == stops_[later].compared.end()) return true;
  if (found->second.accepted) return false;
  constexpr double kMoved_m = 0.3;
  constexpr double kMoved_rad = 0.05;
  const Pose2& before = found->second.T_later_earlier;
  return (before.position_m() - T_later_earlier.position_m()).squaredNorm() > kMoved_m * kMoved_m ||
         std::fabs(geometry::wrap_angle(before.theta_rad - T_later_earlier.theta_rad)) > kMoved_rad;
}

// Stops from this one on are recent.
std::uint32_t Localizer::first_recent(std::uint32_t stop) const {
  std::uint32_t first = stop;
  while (first > 0 && stops_[stop].way_m - stops_[first - 1].way_m <= config_.recent_way_m) --first;
  return first;
}

// Beyond it no stop is searchable().
PoseGraph::Reach Localizer::searchable_reach() const {
  const Eigen::Vector3d unit = search_half_width(
      Eigen::Matrix3d::Identity(), config_.search_probability, config_.search_heading_sigmas);
  const Eigen::Vector3d sigma(config_.largest_half_width_m / unit.x(),
                              config_.largest_half_width_m / unit.y(),
                              config_.largest_half_width_rad / unit.z());
  return {0, PoseGraph::path_cost(sigma.cwiseAbs2().asDiagonal())};
}

bool Localizer::searchable(const UncertainPose& T_reference_query) const {
  const Eigen::Vector3d half = search_half_width(
      T_reference_query.covariance, config_.search_probability, config_.search_heading_sigmas);
  return half.x() <= config_.largest_half_width_m && half.y() <= config_.largest_half_width_m &&
         half.z() <= config_.largest_half_width_rad;
}

MatchTask Localizer::make_task(std::uint32_t reference, std::uint32_t query,
                               const UncertainPose& prior) {
  MatchTask task = match_task(config_, prior);
  task.task_id = next_task_++;
  task.reference_map_id = reference;
  task.query_map_id = query;
  task.reference_hash = stops_[reference].hash;
  task.query_hash = stops_[query].hash;
  task.seed = support::derive_seed(config_.seed, stops_[reference].map->robot_id,
                                   {reference, query, task.task_id});
  return task;
}

std::vector<Localizer::Answer> Localizer::run(const std::vector<MatchTask>& tasks, EdgeKind kind,
                                              std::vector<StepMatch>* evidence) {
  std::vector<Answer> answers;
  if (tasks.empty()) return answers;
  const std::vector<MatchResult> results = pool_.match(tasks);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const MatchTask& task = tasks[i];
    const MatchResult& result = results[i];
    const bool accepted = result.verdict == Verdict::kAccepted;
    stops_[task.reference_map_id].compared[task.query_map_id] = {task.T_reference_query, accepted};
    if (kind == EdgeKind::kSequential) new_solutions_[task.query_map_id] = result.solutions;
    ++counts_.tasks;
    counts_.evaluations += result.evaluations;
    ++counts_.reasons[static_cast<std::size_t>(result.reason)];
    // Not believed, but not refuted either.
    const bool uncertain =
        result.reason == Reason::kDoubtful || result.reason == Reason::kSecondSolution;
    if (evidence != nullptr) {
      const double foreseen =
          expected_overlap(stops_[task.reference_map_id].profile, stops_[task.query_map_id].outline,
                           {task.T_reference_query, task.covariance});
      evidence->push_back(step_match(task, result, foreseen, task.query_map_id));
    }
    const bool solved = result.status == MatchStatus::kSolved;
    const Pose2 T_later_earlier =
        solved ? without_prior(result.T_reference_query, result.covariance,
                               {task.T_reference_query, task.covariance.inverse()})
               : task.T_reference_query;
    const PoseGraphEdge edge{task.query_map_id, task.reference_map_id, kind,
                             geometry::inverse(T_later_earlier),
                             geometry::inverse_covariance(T_later_earlier, result.covariance)};
    if (kind == EdgeKind::kRevisit && !accepted) {
      decide(edge, LoopOutcome::kGate, result.reason, result.fitness);
    }
    if (accepted || uncertain) answers.push_back({edge, accepted, result.fitness});
  }
  return answers;
}

}  // namespace topogeo::localization
