// The part of MapLocalizer that follows a robot whose pose is known.
#include "topogeo/localization/tracking/map_localizer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <Eigen/LU>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/localization/matching/expected_overlap.hpp"
#include "topogeo/localization/matching/match_gate.hpp"
#include "topogeo/support/seed.hpp"

#include "map_localizer_query.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

constexpr std::size_t kTrackingMatches = 3;
constexpr double kFarthestStored_m = 12.0;  // stored stops further away are not compared
constexpr double kGivenPoseRight = 0.9;
constexpr double kHardlyDoubtful = 1.0;  // right matches mostly are below, wrong ones above

topomap::StopPose pose_of(const LocalizedStop& stop) {
  return {stop.id,         stop.stamp_ns, stop.T_map_robot,
          stop.covariance, stop.id,       located(stop.belief.state)};
}

}  // namespace

UncertainPose fused(const std::vector<UncertainPose>& measurements) {
  UncertainPose best = measurements.front();
  if (measurements.size() == 1) return best;
  constexpr int kIterations = 3;  // only the headings are not linear
  for (int i = 0; i < kIterations; ++i) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (const UncertainPose& m : measurements) {
      const Eigen::Matrix3d weight = m.covariance.inverse();
      information += weight;
      gradient += weight * geometry::difference(m.T_a_b, best.T_a_b);
    }
    best.covariance = information.inverse();
    const Eigen::Vector3d step = best.covariance * gradient;
    best.T_a_b = {best.T_a_b.x_m + step.x(), best.T_a_b.y_m + step.y(),
                  geometry::wrap_angle(best.T_a_b.theta_rad + step.z())};
  }
  return best;
}

MapLocalizer::MapLocalizer(LocalizerConfig config, std::shared_ptr<const StoredMap> map,
                           MatchPool& pool, std::uint32_t first_drive_id)
    : config_(config),
      map_(std::move(map)),
      pool_(pool),
      global_({}, map_->maps, map_->trajectory),
      first_drive_id_(first_drive_id) {
  for (const topomap::LocalMap& local_map : map_->maps) {
    hashes_.push_back(topomap::content_hash(local_map));
    pool_.add_map(std::shared_ptr<const topomap::LocalMap>(map_, &local_map));
  }
}

bool MapLocalizer::add(std::shared_ptr<const topomap::LocalMap> added) {
  const topomap::LocalMap& map = *added;
  const auto step = static_cast<std::uint32_t>(stops_.size());
  if (map.id != first_drive_id_ + step) {
    throw std::invalid_argument("map localizer: local map " + std::to_string(map.id) +
                                " came, expected " + std::to_string(first_drive_id_ + step));
  }
  Query query;
  auto renumbered = std::make_shared<topomap::LocalMap>(map);
  renumbered->id = first_id() + step;
  query.map = renumbered;
  query.hash = topomap::content_hash(*query.map);
  pool_.add_map(query.map);
  query.features = extract_scan_features(map.points, map.T_robot_laser);
  query.profile = query.features.profile;
  if (T_odom_last_) {
    query.odometry = odometry_between_stops(*T_odom_last_, map, config_.odometry);
    query.tracked = map.T_previous_robot;
    query.follows = true;
  }
  query.odometry.covariance = invertible(query.odometry.covariance);
  query.way_m = std::sqrt(query.odometry.T_a_b.position_m().squaredNorm());
  T_odom_last_ = map.T_odom_robot;
  believed_ = 0;
  last_step_.reset();
  if (has_pose_) {
    track(query);
  } else {
    search_step(query);
  }
  stops_.push_back({map.id, map.stamp_ns, pose_.T_a_b, pose_.covariance, belief_, believed_});
  return false;
}

// Where the robot should be, what it should see there, and where that puts it.
void MapLocalizer::track(const Query& query) {
  const Pose2 T_map_last = pose_.T_a_b;
  if (query.follows) pose_ = compose(pose_, query.odometry);
  std::vector<MatchTask> tasks;
  const std::vector<Candidate> chosen = candidates(query, pose_, kTrackingMatches);
  for (const Candidate& candidate : chosen) {
    MatchTask task = make_task(query, candidate.stop, pose_);
    if (query.follows) {
      const Pose2 T_map_tracked = T_map_last * query.tracked;
      task.initial_individuals.push_back(
          geometry::between(T_map_tracked, global_.stops()[candidate.stop].T_map_robot));
    }
    tasks.push_back(std::move(task));
  }
  const std::vector<MatchResult> results = pool_.match(tasks);
  StepEvidence evidence;
  evidence.points = query.features.coarse.size();
  evidence.way_m = query.way_m;
  last_step_.emplace().predicted = pose_;
  bool sure = false;
  std::vector<UncertainPose> believed{pose_};
  std::vector<UncertainPose> doubtful{pose_};
  for (std::size_t i = 0; i < results.size(); ++i) {
    const MatchResult& result = results[i];
    count(result);
    evidence.matches.push_back(step_match(tasks[i], result, chosen[i].overlap, std::nullopt));
    last_step_->measured.push_back(measured(chosen[i].stop, result).T_a_b);
    sure |= result.verdict == Verdict::kAccepted && doubt(result) < kHardlyDoubtful;
    if (result.verdict == Verdict::kAccepted) {
      believed.push_back(measured(chosen[i].stop, result));
      last_step_->believed.push_back(
          {static_cast<std::uint32_t>(chosen[i].stop),
           inverse(UncertainPose{result.T_reference_query, result.covariance}), result.fitness});
      ++believed_;
    } else if (result.reason == Reason::kDoubtful || result.reason == Reason::kSecondSolution) {
      doubtful.push_back(measured(chosen[i].stop, result));
    }
  }
  if (believed_ == 0) ++counts_.steps_in_doubt;
  pose_ = fused(believed_ > 0 ? believed : doubtful);
  evidence.covariance = pose_.covariance;
  if (!sure) evidence.better_elsewhere = better_elsewhere(query);
  last_step_->evidence = evidence;
  belief_ = monitor_.add(evidence);
  if (belief_.state != LocalizationState::kLost) return;
  // This stop's scan is where the search begins.
  begin_search();
  propose(query);
  weigh(query);
  ++searched_;
}

// How much better the scan fits another place of the map, if that is a place to be accepted. A
// corridor looks like another one when nothing but the surroundings of a wrong pose is compared.
double MapLocalizer::better_elsewhere(const Query& query) const {
  const GlobalAnswer answer = global_.find(query.map->points, query.map->T_robot_laser);
  if (answer.verdict != Verdict::kAccepted ||
      same_global_place(answer.poses.front().T_map_robot, pose_.T_a_b)) {
    return 0.0;
  }
  const double here = global_.fitness(query.features, pose_.T_a_b);
  return std::max(0.0, answer.poses.front().fitness - here);
}

void MapLocalizer::set_pose(const Pose2& T_map_robot, const Eigen::Matrix3d& covariance) {
  pose_ = {T_map_robot, invertible(covariance)};
  has_pose_ = true;
  hypotheses_.clear();
  monitor_.restart(kGivenPoseRight);
  belief_ = {LocalizationState::kAmbiguous,
             kGivenPoseRight * covariance_confidence(pose_.covariance)};
  if (!stops_.empty()) {
    stops_.back().T_map_robot = pose_.T_a_b;
    stops_.back().covariance = pose_.covariance;
    stops_.back().belief = belief_;
  }
}

void MapLocalizer::start_after(const topomap::LocalMap& map, const Pose2& T_map_robot) {
  constexpr double kSigma_m = 0.1;
  constexpr double kSigma_rad = 0.03;
  set_pose(T_map_robot,
           Eigen::Vector3d(kSigma_m * kSigma_m, kSigma_m * kSigma_m, kSigma_rad * kSigma_rad)
               .asDiagonal());
  T_odom_last_ = map.T_odom_robot;
}

void MapLocalizer::begin_search() {
  has_pose_ = false;
  hypotheses_.clear();
  searched_ = 0;
  ++searches_;
}

void MapLocalizer::search() {
  begin_search();
  belief_ = {LocalizationState::kSearching, 0.0};
}

topomap::Trajectory MapLocalizer::trajectory() const {
  topomap::Trajectory trajectory;
  trajectory.version = stops_.size();
  for (const LocalizedStop& stop : stops_) trajectory.stops.push_back(pose_of(stop));
  return trajectory;
}

std::optional<topomap::StopPose> MapLocalizer::last_stop() const {
  if (stops_.empty()) return std::nullopt;
  return pose_of(stops_.back());
}

// The stored stops that have most in view of what the stop should see, no two of them next to each
// other on the way.
std::vector<MapLocalizer::Candidate> MapLocalizer::candidates(const Query& query,
                                                              const UncertainPose& T_map_robot,
                                                              std::size_t count) const {
  const std::vector<SurfacePoint> outline = outline_of(query.features.coarse);
  std::vector<Candidate> found;
  for (std::size_t i = 0; i < global_.stops().size(); ++i) {
    const StoredStop& stop = global_.stops()[i];
    const Pose2 T = geometry::between(stop.T_map_robot, T_map_robot.T_a_b);
    if (T.position_m().squaredNorm() > kFarthestStored_m * kFarthestStored_m) continue;
    const double overlap = expected_overlap(stop.profile, outline, {T, T_map_robot.covariance});
    if (overlap >= config_.smallest_expected_overlap) found.push_back({i, overlap});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.overlap > b.overlap; });
  std::vector<Candidate> chosen;
  for (const Candidate& candidate : found) {
    if (chosen.size() == count) break;
    const bool neighbour = std::any_of(chosen.begin(), chosen.end(), [&](const Candidate& other) {
      return other.stop + 1 == candidate.stop || candidate.stop + 1 == other.stop;
    });
    if (!neighbour) chosen.push_back(candidate);
  }
  return chosen;
}

MatchTask MapLocalizer::make_task(const Query& query, std::size_t stop,
                                  const UncertainPose& T_map_robot) {
  const UncertainPose T_stored{global_.stops()[stop].T_map_robot, Eigen::Matrix3d::Zero()};
  UncertainPose T_robot_stop = compose(inverse(T_map_robot), T_stored);
  // A search space wider than the configuration allows is cut: the whole map is searched otherwise.
  MatchTask task = match_task(config_, T_robot_stop);
  task.half_width.x() = std::min(task.half_width.x(), config_.largest_half_width_m);
  task.half_width.y() = std::min(task.half_width.y(), config_.largest_half_width_m);
  task.task_id = next_task_++;
  task.reference_map_id = query.map->id;
  task.reference_hash = query.hash;
  task.query_map_id = map_->maps[stop].id;
  task.query_hash = hashes_[stop];
  task.seed = support::derive_seed(config_.seed, query.map->robot_id,
                                   {query.map->id, map_->maps[stop].id, task.task_id});
  return task;
}

// T_map_robot by a match with a stored stop.
UncertainPose MapLocalizer::measured(std::size_t stop, const MatchResult& result) const {
  const UncertainPose T_stored{global_.stops()[stop].T_map_robot, Eigen::Matrix3d::Zero()};
  return compose(T_stored, inverse(UncertainPose{result.T_reference_query, result.covariance}));
}

void MapLocalizer::count(const MatchResult& result) {
  ++counts_.tasks;
  counts_.evaluations += result.evaluations;
  ++counts_.reasons[static_cast<std::size_t>(result.reason)];
}

}  // namespace topogeo::localization
