#include "topogeo/relocalization/map_tracker.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/LU>

#include "topogeo/matching/match_gate.hpp"
#include "topogeo/matching/refinement.hpp"
#include "topogeo/slam/loop/plausible_match.hpp"

#include "continued_place.hpp"
#include "place_search.hpp"
#include "pose_fusion.hpp"
#include "stored_map_matching.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

constexpr std::size_t kTrackingMatches = 3;  // more of them hardly ever change the pose
constexpr double kGivenPoseRight = 0.9;      // operators err, too
constexpr double kHardlyDoubtful = 1.0;      // most right matches are below, most wrong ones above
constexpr std::size_t kPlaces = 8;           // compared at one stop; each costs a match
constexpr std::size_t kFewestSearched = 25;  // thinned points of a scan; fewer prove nothing
constexpr double kLeastConformity = 0.3;     // some points through walls do not refute a place

/// `index` of the stop in the trajectory, which may have several sessions.
topomap::StopPose pose_of(const LocalizedStop& stop, std::size_t index) {
  return {static_cast<std::uint32_t>(index),
          stop.stamp_ns,
          stop.T_map_robot,
          stop.covariance,
          stop.stop,
          located(stop.status.state)};
}

}  // namespace

struct MapTracker::Parts {
  StoredMapMatching matching;
  PlaceSearch search{};
  ContinuedPlace continued{};
  DriveAgreement agreement{};  // of the tracked stops
};

MapTracker::MapTracker(const LocalizerConfig& config, std::shared_ptr<const StoredMap> map,
                       MatchPool& pool)
    : config_(config),
      first_id_(static_cast<std::uint32_t>(map->maps.size())),
      parts_(new Parts{StoredMapMatching(config, std::move(map), pool)}) {}

MapTracker::~MapTracker() = default;

bool MapTracker::add(std::shared_ptr<const topomap::LocalMap> map) {
  const std::uint32_t number = added_++;
  if (last_id_ && last_id_->session == map->stop.session) {
    check_follows(map->stop, *last_id_);
  } else if (last_id_ || last_epoch_) {
    begin_session(map->odometry_epoch);
  }
  last_id_ = map->stop;
  last_epoch_ = map->odometry_epoch;
  pose_is_given_ = false;
  const DriveStop stop = parts_->matching.add(*map, number, T_odom_last_);
  if (stop.follows) parts_->continued.move(stop.step);
  T_odom_last_ = map->T_odom_robot;
  last_step_.reset();
  std::uint32_t accepted = 0;
  if (has_pose_) {
    accepted = track(stop);
  } else {
    if (stop.follows) parts_->search.move(stop.step.T_before_now, stop.step.distance_m);
    compare_continued(stop);
    look_around(stop);
    accepted = decide();
  }
  stops_.push_back({map->stop, map->stamp_ns, pose_.T_a_b, pose_.covariance, status_, accepted});
  ++stops_by_state_.at(static_cast<std::size_t>(status_.state));
  return false;
}

// A restarted local mapper begins another session. Odometry of the same epoch measures the movement
// since; odometry of another epoch carries no information about the pose.
void MapTracker::begin_session(std::uint64_t odometry_epoch) {
  const bool same_odometry = odometry_epoch != 0 && odometry_epoch == last_epoch_;
  if (same_odometry) return;
  T_odom_last_.reset();
  if (!pose_is_given_) search();
}

// --- tracking

// Predicts the pose and the view, and corrects the pose by matches. Returns the number of accepted
// matches.
std::uint32_t MapTracker::track(const DriveStop& stop) {
  if (stop.follows) {
    pose_ = compose(pose_, stop.step.T_before_now);
    parts_->agreement.move(stop.step.distance_m);
    if (!stop.step.matched) parts_->agreement = {};
  }
  const std::vector<MatchCandidate> stored =
      parts_->matching.candidates(stop, pose_, kTrackingMatches);
  const std::vector<MatchTask> tasks = tracking_tasks(stop, stored);
  const std::vector<MatchResult> results = parts_->matching.run(tasks);
  TrackedStep& step = last_step_.emplace();
  step.predicted = pose_;
  step.evidence.points = stop.features.coarse.size();
  step.evidence.distance_m = stop.step.distance_m;
  if (stop.step.match && monitored_) {
    const auto& [task, result] = *stop.step.match;
    // Expected overlap 0: a failed match with the previous stop counts as no contradiction.
    step.evidence.matches.push_back(step_match(task, result, 0.0, monitor_.steps() - 1));
  }
  std::vector<UncertainPose> measured;
  for (std::size_t i = 0; i < results.size(); ++i) {
    measured.push_back(parts_->matching.measured(stored[i].id, results[i]));
  }
  // With a lost heading, a match alone proves nothing.
  const int fewest = heading_is_lost(pose_) ? 2 : 1;
  const std::vector<bool> right =
      of_one_place(measured, agreeing(tasks, results, measured), fewest);
  bool sure = false;
  std::vector<UncertainPose> accepted{pose_};
  std::vector<bool> doubtful(results.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    const MatchResult& result = results[i];
    step.evidence.matches.push_back(step_match(tasks[i], result, stored[i].overlap, std::nullopt));
    StepMatch& evidence = step.evidence.matches.back();
    step.measured.push_back(measured[i].T_a_b);
    if (right[i]) {
      evidence.verdict = Verdict::kAccepted;
      evidence.reason = Reason::kNone;
      sure |= doubt(result) < kHardlyDoubtful || result.verdict != Verdict::kAccepted;
      accepted.push_back(measured[i]);
      step.accepted.push_back({stored[i].id,
                               inverse(UncertainPose{result.T_reference_query, result.covariance}),
                               result.fitness});
      const Pose2 T_scans =
          without_prior(result.T_reference_query, data_covariance(result),
                        weak_prior({tasks[i].T_reference_query, tasks[i].covariance.inverse()}));
      step.scans_alone.push_back(inverse(UncertainPose{T_scans, result.covariance}));
      continue;
    }
    if (result.verdict == Verdict::kAccepted) {  // other matches lead to another place
      evidence.verdict = Verdict::kAmbiguous;
      evidence.reason = Reason::kSecondSolution;
    }
    doubtful[i] =
        evidence.reason == Reason::kDoubtful || evidence.reason == Reason::kSecondSolution;
  }
  if (step.accepted.empty()) {
    ++steps_in_doubt_;
    doubtful = of_one_place(measured, doubtful, fewest);
    for (std::size_t i = 0; i < doubtful.size(); ++i) {
      if (doubtful[i]) accepted.push_back(measured[i]);
    }
  }
  pose_ = fused(accepted);
  step.evidence.covariance = pose_.covariance;
  if (!sure) step.evidence.better_elsewhere = better_elsewhere(stop);
  status_ = monitor_.add(step.evidence);
  monitored_ = true;
  if (status_.state == LocalizationState::kTracking && !step.accepted.empty()) {
    parts_->continued.track(pose_, stop.step.distance_m);
  } else {
    compare_continued(stop);
  }
  if (status_.state == LocalizationState::kLost) {
    begin_search();
    look_around(stop);
  }
  return static_cast<std::uint32_t>(step.accepted.size());
}

// Selects the accepted matches with stored stops: accepted by their gate, or because the poses of
// this stop and the previous ones in the map agree with each other.
std::vector<bool> MapTracker::agreeing(std::span<const MatchTask> tasks,
                                       std::span<const MatchResult> results,
                                       std::span<const UncertainPose> measured) {
  std::vector<bool> right(results.size());
  std::vector<bool> agreed(results.size());
  bool any_accepted = false;
  double agreeing = 0.0;  // confidence of the most confident one
  for (std::size_t i = 0; i < results.size(); ++i) {
    right[i] = results[i].verdict == Verdict::kAccepted;
    agreed[i] = plausible(tasks[i], results[i]) && agree(pose_, measured[i]);
    any_accepted |= right[i] && agreed[i];
    if (!agreed[i]) continue;
    const StepMatch match = step_match(tasks[i], results[i], 0.0, std::nullopt);
    agreeing = std::max(agreeing, match_confidence(match));
  }
  if (agreeing > 0.0) {
    parts_->agreement.add(any_accepted, agreeing);
  } else if (!results.empty()) {
    parts_->agreement.contradict();
  }
  if (!parts_->agreement.enough()) return right;
  for (std::size_t i = 0; i < results.size(); ++i) right[i] = right[i] || agreed[i];
  return right;
}

std::vector<MatchTask> MapTracker::tracking_tasks(const DriveStop& stop,
                                                  std::span<const MatchCandidate> stored) {
  std::vector<MatchTask> tasks;
  for (const MatchCandidate& candidate : stored) {
    tasks.push_back(parts_->matching.task(stop, candidate.id, pose_));
  }
  return tasks;
}

// How much better the scan fits another acceptable place of the map. Comparing only the
// surroundings of a wrong pose would not show it, because one corridor looks like another.
double MapTracker::better_elsewhere(const DriveStop& stop) const {
  const GlobalLocalizer& places = parts_->matching.places();
  const GlobalAnswer answer = places.find(stop.map->points, stop.map->T_robot_laser);
  if (answer.verdict != Verdict::kAccepted ||
      same_global_place(answer.poses.front().T_map_robot, pose_.T_a_b)) {
    return 0.0;
  }
  const double here = places.fitness(stop.features, pose_.T_a_b);
  return std::max(0.0, answer.poses.front().fitness - here);
}

// Compares the view of a stop that is not tracked with the place that the drive leads to.
void MapTracker::compare_continued(const DriveStop& stop) {
  if (!parts_->continued.pose()) return;
  parts_->continued.compare(
      parts_->matching.places().known_view(stop.features, parts_->continued.pose()->T_a_b),
      stop.step.distance_m);
}

// --- searching

void MapTracker::begin_search() {
  has_pose_ = false;
  monitored_ = false;
  parts_->search.begin();
  ++searches_;
}

void MapTracker::search() {
  begin_search();
  pose_is_given_ = false;
  parts_->continued.forget();
  status_ = {LocalizationState::kSearching, 0.0};
}

// Adds the places of the whole map that fit the last metres, and weights all by this stop.
void MapTracker::look_around(const DriveStop& stop) {
  if (stop.features.coarse.size() >= kFewestSearched) {
    if (parts_->continued.pose()) parts_->search.expect(parts_->continued.pose()->T_a_b);
    std::vector<Pose2> T_map_places;
    for (const Climbed& place : parts_->matching.search(stop, kPlaces)) {
      T_map_places.push_back(place.T_map_robot);
    }
    parts_->search.propose(T_map_places);
    if (!parts_->search.hypotheses().empty()) match_hypotheses(stop);
  }
  parts_->search.end_stop();
}

// Matches the stop at each hypothesis with the stored stop that sees it best.
void MapTracker::match_hypotheses(const DriveStop& stop) {
  const GlobalLocalizer& places = parts_->matching.places();
  std::vector<MatchTask> tasks;
  std::vector<std::size_t> stored;
  for (const PlaceHypothesis& hypothesis : parts_->search.hypotheses()) {
    double share = 0.0;
    stored.push_back(places.best_stop(stop.features, hypothesis.pose.T_a_b, share));
    tasks.push_back(parts_->matching.task(stop, stored.back(), hypothesis.pose));
  }
  const std::vector<MatchResult> results = parts_->matching.run(tasks);
  std::vector<double> fitness;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const MatchResult& result = results[i];
    const bool accepted =
        result.verdict == Verdict::kAccepted || result.reason == Reason::kSecondSolution;
    const UncertainPose& predicted = parts_->search.hypotheses()[i].pose;
    std::optional<PlaceSearch::Observation> measured;
    if (accepted || plausible(tasks[i], result)) {
      measured = {parts_->matching.measured(stored[i], result), accepted,
                  match_confidence(step_match(tasks[i], result, 0.0, std::nullopt))};
      if (!agree(predicted, measured->T_map_robot)) measured.reset();
    }
    parts_->search.observe(i, measured);
    fitness.push_back(places.fitness(stop.features, parts_->search.hypotheses()[i].pose.T_a_b) *
                      std::max(kLeastConformity, 1.0 - result.violations));
  }
  parts_->search.weigh(fitness);
}

// Takes the pose of the one place that is left, or the state of the search. Returns 1 if the best
// place was seen at this stop.
std::uint32_t MapTracker::decide() {
  status_ = {LocalizationState::kSearching, 0.0};
  const std::optional<PlaceHypothesis> best = parts_->search.best();
  if (!best) return 0;
  pose_ = best->pose;
  status_.confidence = best->weight * covariance_confidence(pose_.covariance);
  std::uint32_t accepted = 0;
  if (best->seen > 0 && best->weight >= 0.5) {
    status_.state = LocalizationState::kAmbiguous;
    accepted = best->missed == 0 ? 1 : 0;
  }
  if (!PlaceSearch::found(*best, parts_->continued.wanted_m(best->pose))) return accepted;
  if (!parts_->continued.pose() || !parts_->continued.leads_to(best->pose))
    parts_->continued.forget();
  has_pose_ = true;
  StepEvidence evidence;
  evidence.points = kFewestSearched;
  evidence.covariance = pose_.covariance;
  parts_->agreement = best->agreement;
  monitor_.restart(best->weight);
  status_ = monitor_.add(evidence);
  monitored_ = true;
  parts_->search.begin();
  return accepted;
}

// --- poses from elsewhere

void MapTracker::set_pose(const Pose2& T_map_robot, const Eigen::Matrix3d& covariance) {
  pose_ = {T_map_robot, invertible(covariance)};
  has_pose_ = true;
  pose_is_given_ = true;
  monitored_ = false;
  parts_->search.begin();
  parts_->continued.forget();
  parts_->agreement = {};
  monitor_.restart(kGivenPoseRight);
  status_ = {LocalizationState::kAmbiguous,
             kGivenPoseRight * covariance_confidence(pose_.covariance)};
  if (!stops_.empty()) {
    --stops_by_state_.at(static_cast<std::size_t>(stops_.back().status.state));
    ++stops_by_state_.at(static_cast<std::size_t>(status_.state));
    stops_.back().T_map_robot = pose_.T_a_b;
    stops_.back().covariance = pose_.covariance;
    stops_.back().status = status_;
  }
}

void MapTracker::start_after(const topomap::LocalMap& map, const Pose2& T_map_robot) {
  constexpr double kSigma_m = 0.1;  // the last pose of a map is as good as its last match
  constexpr double kSigma_rad = 0.03;
  set_pose(T_map_robot,
           Eigen::Vector3d(kSigma_m * kSigma_m, kSigma_m * kSigma_m, kSigma_rad * kSigma_rad)
               .asDiagonal());
  T_odom_last_ = map.T_odom_robot;
}

void MapTracker::start_after(const LastPlace& place) {
  set_pose(place.T_map_robot.T_a_b, place.T_map_robot.covariance);
  pose_is_given_ = false;
  T_odom_last_ = place.T_odom_robot;
  last_epoch_ = place.odometry_epoch;
}

void MapTracker::forget_stops(std::size_t most) {
  if (stops_.size() < 2 * most) return;  // in batches, not at every stop
  stops_.erase(stops_.begin(), stops_.end() - static_cast<std::ptrdiff_t>(most));
  numbered_since_ = added_;
}

// --- state

topomap::Trajectory MapTracker::trajectory() const {
  topomap::Trajectory trajectory;
  trajectory.version = added_;
  trajectory.numbered_since = numbered_since_;
  for (const LocalizedStop& stop : stops_) {
    trajectory.stops.push_back(pose_of(stop, trajectory.stops.size()));
  }
  return trajectory;
}

std::optional<topomap::StopPose> MapTracker::last_stop() const {
  if (stops_.empty()) return std::nullopt;
  return pose_of(stops_.back(), stops_.size() - 1);
}

void MapTracker::number_tasks_from(std::uint64_t next_task) {
  parts_->matching.requests().number_from(next_task);
}

std::uint64_t MapTracker::next_task() const {
  return parts_->matching.requests().next_task();
}

SlamCounts MapTracker::counts() const {
  SlamCounts counts{parts_->matching.requests().counts()};
  counts.steps_in_doubt = steps_in_doubt_;
  return counts;
}

}  // namespace topogeo::localization
