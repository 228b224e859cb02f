#include <algorithm>
#include <utility>

#include "topogeo/session/merge_proposals.hpp"

#include "slam_counts.hpp"

namespace topogeo::localization {

namespace {

// A new copy of a map costs as much as a search of all of it. It is worth a sixteenth more stops,
// and in a small map a few stops.
constexpr std::size_t kFewStops = 8;
constexpr std::size_t kShare = 16;
// Limit while a robot is followed and no operator agrees to join the maps.
constexpr std::size_t kMostSightings = 3072;

bool is_tracked(const MapTracker& tracker) {
  return tracker.status().state == LocalizationState::kTracking;
}

}  // namespace

Meeting::Meeting(const LocalizerConfig& config, std::unique_ptr<MatchPool> pool)
    : config_(config), pool_(std::move(pool)) {}

bool Meeting::wants_map(std::size_t stops) const {
  return stops > 0 && (!map_tracker_ || stops >= renew_at_ || stops < map_->maps.size());
}

void Meeting::set_map(std::shared_ptr<const StoredMap> map,
                      std::span<const MapPointer> last_stops) {
  std::optional<geometry::Pose2> T_map_last;
  if (map_tracker_ && is_tracked(*map_tracker_)) {
    // Pose relative to a stop that it was matched with, which may have moved since.
    const geometry::Pose2 before = map_tracker_->last_stop()->T_map_robot;
    T_map_last = before;
    for (const Sighting& sighting : newest()) {
      const auto same = std::ranges::find_if(
          map->maps, [&](const topomap::LocalMap& held) { return held.stop == sighting.other; });
      if (same == map->maps.end()) continue;
      T_map_last = map->trajectory.stops[same->id].T_map_robot * sighting.T_other_stop.T_a_b;
      break;
    }
  }
  if (map_tracker_) add_counts(counts_before_, map_tracker_->counts());
  map_ = std::move(map);
  renew_at_ = map_->maps.size() + std::max(kFewStops, map_->maps.size() / kShare);
  map_tracker_ = std::make_unique<MapTracker>(config_, map_, *pool_);
  if (T_map_last) {
    map_tracker_->start_after(*last_, *T_map_last);
    return;
  }
  forget();
  for (const MapPointer& stop : last_stops) add(stop);
}

void Meeting::expect(const MapPointer& last, const UncertainPose& T_map_robot) {
  if (is_tracked(*map_tracker_)) return;
  if (map_tracker_->stops().empty()) map_tracker_->start_after(*last, T_map_robot.T_a_b);
  map_tracker_->set_pose(T_map_robot.T_a_b, T_map_robot.covariance);
}

bool Meeting::add(const MapPointer& map) {
  follow(map);
  return confirmation_.add(*map_tracker_);
}

void Meeting::follow(const MapPointer& map) {
  map_tracker_->add(map);
  map_tracker_->forget_stops(kFewStops);
  last_ = map;
  if (!is_tracked(*map_tracker_)) sightings_.clear();
  if (sightings_.size() > kMostSightings) {
    sightings_.erase(sightings_.begin(), sightings_.begin() + kMostSightings / 2);
  }
  newest_ = sightings_.size();
  if (!tracked_well(*map_tracker_)) return;
  const TrackedStep& step = *map_tracker_->last_step();
  for (std::size_t i = 0; i < step.accepted.size(); ++i) {
    const StoredMatch& match = step.accepted[i];
    sightings_.push_back(
        {map->stop, map_->maps[match.stop].stop, step.scans_alone[i], match.fitness});
  }
}

std::span<const Sighting> Meeting::newest() const {
  return std::span(sightings_).subspan(newest_);
}

void Meeting::forget() {
  confirmation_.begin_searched();
  sightings_.clear();
  newest_ = 0;
}

SlamCounts Meeting::counts() const {
  SlamCounts counts = map_tracker_ ? map_tracker_->counts() : SlamCounts{};
  add_counts(counts, counts_before_);
  return counts;
}

}  // namespace topogeo::localization
