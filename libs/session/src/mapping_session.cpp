#include "topogeo/session/mapping_session.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/session/slam_session.hpp"

#include "slam_counts.hpp"

namespace topogeo::localization {

MappingSession::MappingSession(const LocalizerConfig& config, MatchPool& pool,
                               GraphOptimizer* optimizer)
    : config_(config),
      pool_(pool),
      optimizer_(optimizer),
      mapper_(make_slam(config, pool, optimizer)) {
  pose_graph_slam_ = dynamic_cast<PoseGraphSlam*>(mapper_.get());
}

MappingSession::MappingSession(const LocalizerConfig& config, MatchPool& pool,
                               GraphOptimizer* optimizer, std::shared_ptr<const StoredMap> map,
                               const std::optional<UncertainPose>& initial)
    : config_(config), pool_(pool), optimizer_(optimizer) {
  if (config.mode != SlamAlgorithm::kGraph) {
    throw std::invalid_argument("localizer.mode: a stored map is continued in mode graph only");
  }
  take_map(map);
  stored_stops_ = map->maps.size();
  start_following(std::move(map));
  if (initial) map_tracker_->set_pose(initial->T_a_b, initial->covariance);
}

void MappingSession::take_map(const std::shared_ptr<const StoredMap>& map) {
  auto slam = std::make_unique<PoseGraphSlam>(config_, pool_, optimizer_, map);
  pose_graph_slam_ = slam.get();
  mapper_ = std::move(slam);
  maps_.clear();
  for (const topomap::LocalMap& stored : map->maps) maps_.push_back(MapPointer(map, &stored));
  stands_for_ = map->trajectory.stops;
  numbered_since_ = map->trajectory.numbered_since;
  renew_at_ = std::max(long_drive_.stops, 2 * maps_.size());
}

void MappingSession::set_long_drive(const LongDrive& limits) {
  long_drive_ = limits;
  renew_at_ = std::max(long_drive_.stops, 2 * maps_.size());
}

void MappingSession::resume_session() {
  map_tracker_->start_after(*maps_.back(), mapper_->trajectory().stops.back().T_map_robot);
  last_id_ = maps_.back()->stop;
}

bool MappingSession::add(MapPointer map) {
  const bool same_session = last_id_ && last_id_->session == map->stop.session;
  if (same_session) check_follows(map->stop, *last_id_);
  const auto is_of_robot = [&](const MapPointer& held) { return held->robot_id == map->robot_id; };
  if (!maps_.empty() && std::ranges::none_of(maps_, is_of_robot)) {
    throw std::invalid_argument("localizer: a stop of robot '" + map->robot_id +
                                "', expected a robot that has stops in the map");
  }
  if (last_id_ && !same_session) begin_drive(*map);
  last_id_ = map->stop;
  ++stops_;
  return map_tracker_ ? follow(map) : map_stop(map);
}

// The tracker finds out by itself that the robot may be anywhere.
void MappingSession::begin_drive(const topomap::LocalMap& map) {
  waiting_.clear();
  confirmation_.begin();
  if (map_tracker_ || maps_.empty()) return;
  if (pose_graph_slam_ == nullptr) {
    throw std::invalid_argument("localizer: stop " + std::to_string(map.stop.number) +
                                " is of another drive, which mode thesis cannot join to its map");
  }
  start_following(map_so_far());
}

std::shared_ptr<const StoredMap> MappingSession::map_so_far() const {
  auto stored = std::make_shared<StoredMap>();
  stored->trajectory = trajectory();
  stored->loop_closures = mapper_->loop_closures();
  stored->edges = mapper_->edges();
  for (const MapPointer& map : maps_) stored->maps.push_back(*map);
  return stored;
}

bool MappingSession::map_stop(const MapPointer& map) {
  const MapPointer own = numbered(map, false);
  const bool moved = mapper_->add(own);
  add_to_map(own);
  if (maps_.size() >= renew_at_ && pose_graph_slam_ != nullptr) renew_long_drive();
  return moved;
}

void MappingSession::add_to_map(MapPointer map) {
  maps_.push_back(std::move(map));
  stands_for_.emplace_back();
  ++added_;
}

bool MappingSession::follow(const MapPointer& map) {
  map_tracker_->add(map);
  const bool found = confirmation_.add(*map_tracker_);
  if (!mapping_) return false;
  waiting_.push_back(map);
  if (waiting_.size() > kMostWaiting) waiting_.erase(waiting_.begin());
  map_tracker_->forget_stops(kMostWaiting);
  if (found) join();
  return found;
}

void MappingSession::join() {
  std::vector<StoredMatch> matches = map_tracker_->last_step()->accepted;
  if (const auto by = renew(0)) matches = renewed(std::move(matches), *by);
  const double confidence = map_tracker_->status().confidence;
  std::vector<MapPointer> drive;
  for (const MapPointer& map : std::exchange(waiting_, {})) {
    const bool follows = !maps_.empty() && maps_.back()->stop.next() == map->stop;
    drive.push_back(numbered(map, !follows));
    add_to_map(drive.back());
  }
  end_following();
  pose_graph_slam_->join(drive, matches, confidence);
}

std::optional<MappingSession::Renewed> MappingSession::renew(std::size_t untouched) {
  if (keeps_all_) return std::nullopt;
  pose_graph_slam_->settle();
  std::shared_ptr<const StoredMap> before = map_so_far();
  KeptViews kept(before->maps, before->trajectory.stops, kKeptTimes, untouched,
                 long_drive_.stops_of_drive);
  if (kept.dropped() == 0) return std::nullopt;
  const std::uint64_t next_task = pose_graph_slam_->next_task();
  add_counts(counts_before_, mapper_->counts());
  take_map(std::make_shared<const StoredMap>(with_kept_views(*before, kept)));
  pose_graph_slam_->number_tasks_from(next_task);
  return Renewed{std::move(before), std::move(kept)};
}

std::vector<StoredMatch> MappingSession::renewed(std::vector<StoredMatch> matches,
                                                 const Renewed& by) {
  const std::vector<topomap::StopPose>& stops = by.before->trajectory.stops;
  for (StoredMatch& match : matches) {
    const std::uint32_t stands = by.kept.stands_for(match.stop);
    if (stands != match.stop) {
      const UncertainPose T_stands_stop{
          geometry::between(stops[stands].T_map_robot, stops[match.stop].T_map_robot),
          usual_match_covariance()};
      match.T_stop_robot = compose(T_stands_stop, match.T_stop_robot);
    }
    match.stop = by.kept.new_id(stands);
  }
  return matches;
}

// The robot is followed from its last stop; at the next matched stop mapping continues.
void MappingSession::renew_long_drive() {
  const auto by = renew(long_drive_.untouched);
  renew_at_ = std::max(long_drive_.stops, maps_.size() + long_drive_.stops / 2);
  if (!by) return;
  start_following(map_so_far());
  map_tracker_->start_after(*maps_.back(), mapper_->trajectory().stops.back().T_map_robot);
}

// A copy numbered after the last stop of the map.
MappingSession::MapPointer MappingSession::numbered(const MapPointer& map,
                                                    bool starts_drive) const {
  const auto id = static_cast<std::uint32_t>(maps_.size());
  starts_drive &= id > 0;
  if (map->id == id && !starts_drive) return map;
  return std::make_shared<const topomap::LocalMap>(topomap::numbered(*map, id, starts_drive));
}

void MappingSession::finish() {
  if (!map_tracker_ && added_ > 0) mapper_->finish();
}

// --- switching between mapping and localizing

void MappingSession::stop_mapping() {
  if (!mapping_) throw std::logic_error("mapping is already stopped");
  if (maps_.empty()) throw std::logic_error("there is no map yet");
  if (!map_tracker_) {
    std::shared_ptr<const StoredMap> stored = map_so_far();
    const geometry::Pose2 T_map_last = stored->trajectory.stops.back().T_map_robot;
    start_following(std::move(stored));
    map_tracker_->start_after(*maps_.back(), T_map_last);
  }
  waiting_.clear();
  mapping_ = false;
}

void MappingSession::resume_mapping() {
  if (mapping_) throw std::logic_error("mapping is already active");
  if (pose_graph_slam_ == nullptr) {
    throw std::invalid_argument("localizer.mode: a finished map is continued in mode graph only");
  }
  mapping_ = true;
}

void MappingSession::start_following(std::shared_ptr<const StoredMap> map) {
  const std::uint64_t next_task =
      pose_graph_slam_ != nullptr ? pose_graph_slam_->next_task() : counts().tasks;
  map_tracker_ = std::make_unique<MapTracker>(config_, std::move(map), pool_);
  map_tracker_->number_tasks_from(next_task);
  confirmation_.begin();
}

void MappingSession::end_following() {
  pose_graph_slam_->number_tasks_from(map_tracker_->next_task());
  add_counts(counts_before_, map_tracker_->counts());
  map_tracker_.reset();
}

// --- state

topomap::Trajectory MappingSession::trajectory() const {
  topomap::Trajectory trajectory = mapper_->trajectory();
  trajectory.numbered_since = numbered_since_;
  for (std::size_t i = 0; i < trajectory.stops.size(); ++i) {
    topomap::StopPose& stop = trajectory.stops[i];
    stop.stop = maps_[i]->stop;
    stop.views = stands_for_[i].views;
    stop.last_view_ns = stands_for_[i].last_view_ns;
  }
  return trajectory;
}

std::optional<topomap::StopPose> MappingSession::last_stop() const {
  if (stops_ == 0) return std::nullopt;
  if (map_tracker_ && !map_tracker_->stops().empty()) return map_tracker_->last_stop();
  std::optional<topomap::StopPose> stop = mapper_->last_stop();
  stop->stop = maps_.back()->stop;  // mapped, or just after stop_mapping()
  return stop;
}

SlamCounts MappingSession::counts() const {
  SlamCounts counts = mapper_->counts();
  add_counts(counts, counts_before_);
  if (map_tracker_) add_counts(counts, map_tracker_->counts());
  return counts;
}

}  // namespace topogeo::localization
