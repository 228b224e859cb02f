#include "topogeo/localization/thesis/thesis_localizer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "topogeo/localization/matching/expected_overlap.hpp"
#include "topogeo/support/seed.hpp"

namespace topogeo::localization {

using geometry::Pose2;
using topomap::LocalMap;

namespace {

bool may_be_right(const MatchResult& result) {
  return result.verdict == Verdict::kAccepted || result.reason == Reason::kDoubtful ||
         result.reason == Reason::kSecondSolution;
}

}  // namespace

ThesisLocalizer::ThesisLocalizer(const LocalizerConfig& config, MatchPool& pool,
                                 const ThesisConfig& thesis)
    : config_(config), thesis_(thesis), pool_(pool), store_(thesis.cycle_solutions) {
  thesis_.backward.resolution_m = config.genetic.resolution_m;
  thesis_.backward.resolution_rad = config.genetic.resolution_rad;
}

bool ThesisLocalizer::add(std::shared_ptr<const LocalMap> map) {
  append(std::move(map));
  const auto stop = static_cast<std::uint32_t>(stops_.size() - 1);
  ++version_;
  if (stop == 0) {
    graph_.add_pose(Pose2{});
    belief_ = {LocalizationState::kTracking, 1.0};
    return false;
  }
  forward(stop);
  return close_cycles(stop);
}

void ThesisLocalizer::append(std::shared_ptr<const LocalMap> map) {
  check_next(*map, stops_.size(), stops_.empty() ? nullptr : stops_.front().map.get());
  pool_.add_map(map);
  Stop stop;
  stop.hash = topomap::content_hash(*map);
  stop.view = visible_rectangle(*map);
  MatchFeatures features = extract_scan_features(map->points, map->T_robot_laser);
  stop.profile = std::move(features.profile);
  stop.outline = outline_of(features.coarse);
  if (!stops_.empty()) {
    const Stop& previous = stops_.back();
    stop.T_previous_this =
        odometry_between_stops(previous.map->T_odom_robot, *map, config_.odometry);
    stop.T_previous_this.covariance = invertible(stop.T_previous_this.covariance);
    stop.way_m = previous.way_m + std::sqrt(stop.T_previous_this.T_a_b.position_m().squaredNorm());
  }
  stop.map = std::move(map);
  stops_.push_back(std::move(stop));
}

bool ThesisLocalizer::recent(std::uint32_t earlier, std::uint32_t stop) const {
  return stops_[stop].way_m - stops_[earlier].way_m <= config_.recent_way_m;
}

// Steps 2 to 6 of 7.3.1.1.1: the earlier maps whose field of view overlaps, with enough in common
// to match them. `relative`: every earlier stop seen from the new one.
std::vector<ThesisLocalizer::Neighbour> ThesisLocalizer::neighbours(
    std::uint32_t stop, const Pose2& T_map_predicted,
    std::span<const UncertainPose> relative) const {
  std::vector<Neighbour> found;
  const Stop& now = stops_[stop];
  for (std::uint32_t i = 0; i < stop; ++i) {
    const Stop& before = stops_[i];
    const UncertainPose& pose = relative[i];
    const Eigen::Vector3d half = search_half_width(pose.covariance, config_.search_probability,
                                                   config_.search_heading_sigmas);
    if (half.head<2>().maxCoeff() > config_.largest_half_width_m ||
        half.z() > config_.largest_half_width_rad) {
      continue;  // a search that wide finds look-alikes
    }
    const Pose2 T_earlier_new = geometry::between(graph_.poses()[i], T_map_predicted);
    if (!overlap(seen_from(now.view, T_earlier_new, half), before.view)) continue;
    const double share = expected_overlap(now.profile, before.outline, pose);
    if (share >= config_.smallest_expected_overlap || i + 1 == stop) {
      found.push_back({i, pose, share});
    }
  }
  return found;
}

std::vector<ThesisLocalizer::Match> ThesisLocalizer::match(std::uint32_t stop,
                                                           const std::vector<Neighbour>& with,
                                                           std::uint32_t solutions) {
  std::vector<MatchTask> tasks;
  for (const Neighbour& neighbour : with) {
    MatchTask task = match_task(config_, neighbour.T_new_earlier);
    task.solutions_wanted = solutions;
    task.task_id = next_task_++;
    task.reference_map_id = stop;
    task.query_map_id = neighbour.id;
    task.reference_hash = stops_[stop].hash;
    task.query_hash = stops_[neighbour.id].hash;
    task.seed = support::derive_seed(config_.seed, stops_[stop].map->robot_id,
                                     {stop, neighbour.id, task.task_id});
    const auto known = last_solutions_.find(neighbour.id);
    if (known != last_solutions_.end()) {
      const Pose2 T_now_before = geometry::inverse(stops_[stop].T_previous_this.T_a_b);
      for (const MatchSolution& solution : known->second) {
        task.initial_individuals.push_back(T_now_before * solution.T_reference_query);
      }
    }
    tasks.push_back(std::move(task));
  }
  std::vector<Match> matches;
  if (tasks.empty()) return matches;
  std::vector<MatchResult> results = pool_.match(tasks);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    Match& found = matches.emplace_back();
    found.earlier = tasks[i].query_map_id;
    found.result = std::move(results[i]);
    if (found.result.status == MatchStatus::kSolved) {
      found.T_earlier_new = {
          geometry::inverse(found.result.T_reference_query),
          geometry::inverse_covariance(found.result.T_reference_query, found.result.covariance)};
    }
    ++counts_.tasks;
    counts_.evaluations += found.result.evaluations;
    ++counts_.reasons[static_cast<std::size_t>(found.result.reason)];
  }
  return matches;
}

// The n best solutions (def. 7.3.4): the refined one, then those of the search that lie elsewhere.
void ThesisLocalizer::store(std::uint32_t stop, const Match& match) {
  const double cell_m = config_.genetic.resolution_m;
  const double cell_rad = config_.genetic.resolution_rad;
  const Eigen::Matrix3d unrefined =
      Eigen::Vector3d(cell_m * cell_m, cell_m * cell_m, cell_rad * cell_rad).asDiagonal();
  std::vector<RelativeSolution> solutions{
      {match.T_earlier_new.T_a_b, match.T_earlier_new.covariance, match.result.fitness}};
  for (const MatchSolution& solution : match.result.solutions) {
    const Eigen::Vector3d off =
        geometry::difference(solution.T_reference_query, match.result.T_reference_query);
    if (std::fabs(off.x()) <= cell_m && std::fabs(off.y()) <= cell_m &&
        std::fabs(off.z()) <= cell_rad) {
      continue;
    }
    solutions.push_back({geometry::inverse(solution.T_reference_query),
                         geometry::inverse_covariance(solution.T_reference_query, unrefined),
                         std::min(solution.fitness, match.result.fitness)});
  }
  store_.put(match.earlier, stop, std::move(solutions));
}

topomap::Trajectory ThesisLocalizer::trajectory() const {
  topomap::Trajectory trajectory;
  trajectory.version = version_;
  for (std::size_t i = 0; i < stops_.size(); ++i) trajectory.stops.push_back(pose_of(i));
  return trajectory;
}

std::optional<topomap::StopPose> ThesisLocalizer::last_stop() const {
  if (stops_.empty()) return std::nullopt;
  return pose_of(stops_.size() - 1);
}

topomap::StopPose ThesisLocalizer::pose_of(std::size_t stop) const {
  const LocalMap& map = *stops_[stop].map;
  return {map.id, map.stamp_ns, graph_.poses()[stop], stops_[stop].covariance, map.id};
}

// --- forward correction (7.3.1.1.1)

void ThesisLocalizer::forward(std::uint32_t stop) {
  Stop& now = stops_[stop];
  const UncertainPose& odometry = now.T_previous_this;
  const Pose2 T_map_predicted = graph_.poses().back() * odometry.T_a_b;  // step 1
  const Pose2 T_new_previous = geometry::inverse(odometry.T_a_b);
  const Eigen::Matrix3d covariance =
      geometry::inverse_covariance(odometry.T_a_b, odometry.covariance);
  std::vector<UncertainPose> relative = graph_.relative_to(stop - 1);
  for (UncertainPose& pose : relative) {  // from the previous stop to the new one
    pose = {T_new_previous * pose.T_a_b,
            geometry::compose_covariance(T_new_previous, covariance, pose.T_a_b, pose.covariance)};
  }
  std::vector<Neighbour> with = neighbours(stop, T_map_predicted, relative);
  for (const Neighbour& neighbour : with) now.overlaps.push_back(neighbour.id);
  // What was not recent and not seen just before is left to the closing of cycles.
  const std::vector<std::uint32_t> fresh =
      newly_seen(now.overlaps, stops_[stop - 1].overlaps, stop - 1);
  std::erase_if(with, [&](const Neighbour& n) {
    return !recent(n.id, stop) &&
           (config_.revisit_matches == 0 || std::binary_search(fresh.begin(), fresh.end(), n.id));
  });
  std::stable_sort(with.begin(), with.end(), [&](const Neighbour& a, const Neighbour& b) {
    const bool previous_a = a.id + 1 == stop;
    const bool previous_b = b.id + 1 == stop;
    return previous_a != previous_b ? previous_a : a.overlap > b.overlap;
  });
  if (with.size() > thesis_.matches) with.resize(thesis_.matches);

  const std::vector<Match> matches = match(stop, with, config_.solutions_wanted);  // step 7
  last_solutions_.clear();
  const Match* best = nullptr;
  for (const Match& match : matches) {
    last_solutions_[match.earlier] = match.result.solutions;
    if (!may_be_right(match.result)) continue;
    store(stop, match);
    const bool accepted = match.result.verdict == Verdict::kAccepted;
    const bool best_accepted = best != nullptr && best->result.verdict == Verdict::kAccepted;
    if (best == nullptr || (accepted && !best_accepted) ||
        (accepted == best_accepted && match.result.fitness > best->result.fitness)) {
      best = &match;
    }
  }
  const std::uint32_t from = best == nullptr ? stop - 1 : best->earlier;
  const UncertainPose& step = best == nullptr ? odometry : best->T_earlier_new;
  const Pose2 T_map_from = graph_.poses()[from];
  graph_.add_pose(T_map_from * step.T_a_b);  // steps 8 and 9
  graph_.add_edge({stop - 1, stop, EdgeKind::kOdometry, odometry.T_a_b, odometry.covariance});
  if (best != nullptr) {
    graph_.add_edge({from, stop, EdgeKind::kSequential, step.T_a_b, step.covariance});
  }
  now.covariance = geometry::compose_covariance(T_map_from, stops_[from].covariance, step.T_a_b,
                                                step.covariance);
  const bool sure = best != nullptr && best->result.verdict == Verdict::kAccepted;
  if (!sure) ++counts_.steps_in_doubt;
  const double fitness = best == nullptr ? 0.0 : best->result.fitness;
  belief_ = {sure ? LocalizationState::kTracking : LocalizationState::kAmbiguous,
             sure ? fitness : 0.5 * fitness};
}

}  // namespace topogeo::localization
