#include "topogeo/thesis/thesis_slam.hpp"

#include <algorithm>
#include <utility>

namespace topogeo::localization {

using geometry::Pose2;

namespace {

bool may_be_right(const MatchResult& result) {
  return result.verdict == Verdict::kAccepted || result.reason == Reason::kDoubtful ||
         result.reason == Reason::kSecondSolution;
}

// The grid of the backward correction is that of the genetic search.
ThesisSlamConfig with_one_resolution(ThesisSlamConfig config) {
  config.thesis.backward.resolution_m = config.genetic.resolution_m;
  config.thesis.backward.resolution_rad = config.genetic.resolution_rad;
  return config;
}

}  // namespace

ThesisSlam::ThesisSlam(const ThesisSlamConfig& config, MatchPool& pool)
    : config_(with_one_resolution(config)),
      map_(config_, config_.thesis.cycle_solutions),
      matching_(config_, pool),
      cycles_(config_),
      kept_(config_) {}

bool ThesisSlam::add(std::shared_ptr<const topomap::LocalMap> map) {
  map_.append(std::move(map));
  matching_.add(map_);
  const bool keeps = config_.thesis.kept_solutions > 0;
  if (map_.size() == 1) {
    map_.place_first();
    if (keeps) kept_.add_stop(map_);
    status_ = {LocalizationState::kTracking, 1.0};
    return false;
  }
  correct_forward();
  if (!keeps) return cycles_.close(map_, matching_);
  const std::vector<Pose2> before = poses();
  kept_.add_stop(map_);
  if (config_.revisit_matches > 0) kept_.offer(map_, cycles_.solutions(map_, matching_));
  const std::vector<Pose2>& now = poses();
  const bool moved = !std::equal(before.begin(), before.end(), now.begin());
  if (moved) ++kept_version_;
  return moved;
}

void ThesisSlam::finish() {
  if (kept_.best() == nullptr) return;
  kept_.refine(map_);
  ++kept_version_;
}

const std::vector<Pose2>& ThesisSlam::poses() const {
  const CycleSolution* best = kept_.best();
  return best != nullptr && best->T_map_stop.size() == map_.size() ? best->T_map_stop
                                                                   : map_.poses();
}

std::vector<topomap::LoopClosure> ThesisSlam::loop_closures() const {
  const CycleSolution* best = kept_.best();
  if (best == nullptr) return cycles_.closures();
  return {{best->earlier, best->later,
           geometry::between(best->T_map_stop[best->earlier], best->T_map_stop[best->later])}};
}

// Thesis, 7.3.1.1.1.
void ThesisSlam::correct_forward() {
  const auto stop = static_cast<std::uint32_t>(map_.size() - 1);
  const std::vector<ThesisMatch> matches =
      matching_.match(map_, forward_neighbours(), config_.solutions_wanted);  // step 7
  matching_.remember(matches);
  const ThesisMatch* best = best_of(matches);
  if (best == nullptr) {
    map_.place(stop - 1, map_.stop(stop).T_previous_this, false);
  } else {
    map_.place(best->earlier, best->T_earlier_new, true);  // steps 8 and 9
  }
  const bool sure = best != nullptr && best->result.verdict == Verdict::kAccepted;
  if (!sure) ++steps_in_doubt_;
  const double fitness = best == nullptr ? 0.0 : best->result.fitness;
  status_ = {sure ? LocalizationState::kTracking : LocalizationState::kAmbiguous,
             sure ? fitness : 0.5 * fitness};
}

// Steps 1 to 6: the overlapping maps at the pose by odometry, best first; stores the overlaps. Maps
// that are neither recent nor seen by the previous stop are left to the closing of cycles.
std::vector<ThesisNeighbour> ThesisSlam::forward_neighbours() {
  const auto stop = static_cast<std::uint32_t>(map_.size() - 1);
  const UncertainPose& odometry = map_.stop(stop).T_previous_this;
  const Pose2 T_map_predicted = map_.poses().back() * odometry.T_a_b;
  const Pose2 T_new_previous = geometry::inverse(odometry.T_a_b);
  const Eigen::Matrix3d covariance =
      geometry::inverse_covariance(odometry.T_a_b, odometry.covariance);
  std::vector<UncertainPose> relative = map_.relative_to(stop - 1);
  for (UncertainPose& pose : relative) {  // from the previous stop to the new one
    pose = {T_new_previous * pose.T_a_b,
            geometry::compose_covariance(T_new_previous, covariance, pose.T_a_b, pose.covariance)};
  }
  std::vector<ThesisNeighbour> with = map_.neighbours(stop, T_map_predicted, relative);
  std::vector<std::uint32_t> overlaps;
  overlaps.reserve(with.size());
  for (const ThesisNeighbour& neighbour : with) overlaps.push_back(neighbour.id);
  const std::vector<std::uint32_t> fresh =
      topomap::newly_seen(overlaps, map_.stop(stop - 1).overlaps, stop - 1);
  map_.set_overlaps(stop, std::move(overlaps));
  std::erase_if(with, [&](const ThesisNeighbour& n) {
    return !map_.recent(n.id, stop) &&
           (config_.revisit_matches == 0 || config_.thesis.kept_solutions > 0 ||
            std::binary_search(fresh.begin(), fresh.end(), n.id));
  });
  std::stable_sort(with.begin(), with.end(),
                   [&](const ThesisNeighbour& a, const ThesisNeighbour& b) {
                     const bool previous_a = a.id + 1 == stop;
                     const bool previous_b = b.id + 1 == stop;
                     return previous_a != previous_b ? previous_a : a.overlap > b.overlap;
                   });
  if (with.size() > config_.thesis.matches) with.resize(config_.thesis.matches);
  return with;
}

// Stores the solutions of all matches that may be right and returns the fittest accepted one, or
// the fittest of all if none is accepted.
const ThesisMatch* ThesisSlam::best_of(const std::vector<ThesisMatch>& matches) {
  const auto stop = static_cast<std::uint32_t>(map_.size() - 1);
  const ThesisMatch* best = nullptr;
  for (const ThesisMatch& match : matches) {
    if (!may_be_right(match.result)) continue;
    map_.store(stop, match);
    const bool accepted = match.result.verdict == Verdict::kAccepted;
    const bool best_accepted = best != nullptr && best->result.verdict == Verdict::kAccepted;
    if (best == nullptr || (accepted && !best_accepted) ||
        (accepted == best_accepted && match.result.fitness > best->result.fitness)) {
      best = &match;
    }
  }
  return best;
}

topomap::Trajectory ThesisSlam::trajectory() const {
  topomap::Trajectory trajectory;
  trajectory.version = map_.version() + kept_version_;
  for (std::size_t i = 0; i < map_.size(); ++i) {
    trajectory.stops.push_back(map_.pose_of(i));
    trajectory.stops.back().T_map_robot = poses()[i];
  }
  return trajectory;
}

std::optional<topomap::StopPose> ThesisSlam::last_stop() const {
  if (map_.size() == 0) return std::nullopt;
  topomap::StopPose last = map_.pose_of(map_.size() - 1);
  last.T_map_robot = poses().back();
  return last;
}

SlamCounts ThesisSlam::counts() const {
  SlamCounts counts{matching_.counts()};
  counts.steps_in_doubt = steps_in_doubt_;
  counts.optimizations = cycles_.attempts();
  counts.failed_optimizations = cycles_.failures();
  return counts;
}

}  // namespace topogeo::localization
