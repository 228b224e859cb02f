#include "revisit_runs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/relocalization/map_tracker.hpp"
#include "topogeo/support/cpu_time.hpp"

namespace topogeo::bench {

using geometry::Pose2;
using localization::LocalizationState;

namespace {

constexpr std::size_t kFirst = 60;
constexpr std::size_t kOlder = 40;
constexpr std::size_t kLeftOut = 30;  // scans between the map and the drive
constexpr double kSamePlace_m = 2.0;
constexpr double kSameView_rad = 1.0;
constexpr double kGoesOn = 0.5;  // share of the drive's scans at a known place

bool was_here(const Recording& recording, std::size_t scan, std::size_t end) {
  const std::optional<Pose2>& here = recording.T_world_robot[scan];
  if (!here) return false;
  for (std::size_t i = 0; i < end; ++i) {
    const std::optional<Pose2>& there = recording.T_world_robot[i];
    if (!there) continue;
    if ((here->position_m() - there->position_m()).norm() < kSamePlace_m &&
        std::fabs(geometry::wrap_angle(here->theta_rad - there->theta_rad)) < kSameView_rad) {
      return true;
    }
  }
  return false;
}

/// A map that grows by the scans before each revisit.
class GrowingStoredMap {
 public:
  GrowingStoredMap(const Recording& recording, const pipeline::Config& config)
      : recording_(recording), run_(config, "robot") {}

  void grow(std::size_t end) {
    for (; next_ < end; ++next_) {
      if (!recording_.T_world_robot[next_]) continue;
      scan::Scan scan = recording_.scans[next_];
      scan.T_odom_robot = *recording_.T_world_robot[next_];
      scan.sequence = truths_.size();  // without gaps
      truths_.push_back(*recording_.T_world_robot[next_]);
      run_.add(scan);
    }
  }

  [[nodiscard]] std::shared_ptr<const localization::StoredMap> stored() const {
    auto map = std::make_shared<localization::StoredMap>();
    for (const auto& local_map : run_.session()->maps()) map->maps.push_back(*local_map);
    map->trajectory = run_.session()->trajectory();
    return map;
  }

  /// The true pose of a stop of the map.
  [[nodiscard]] const Pose2& truth_of(const topomap::LocalMap& stop) const {
    return truths_[stop.sequence];
  }

 private:
  const Recording& recording_;
  pipeline::MappingRun run_;
  std::size_t next_ = 0;
  std::vector<Pose2> truths_;  // of the scans in the map
};

/// True pose in the map, relative to the stop that is nearest in truth.
Pose2 truth_in(const localization::StoredMap& map, const GrowingStoredMap& made,
               const Pose2& T_world_robot) {
  std::size_t best = 0;
  double best_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < map.maps.size(); ++i) {
    const double m = (made.truth_of(map.maps[i]).position_m() - T_world_robot.position_m()).norm();
    if (m < best_m) {
      best = i;
      best_m = m;
    }
  }
  return map.trajectory.stops[best].T_map_robot *
         geometry::between(made.truth_of(map.maps[best]), T_world_robot);
}

RevisitRun drive(const Recording& recording, const pipeline::Config& config,
                 const RevisitOptions& options, const GrowingStoredMap& made, std::size_t first) {
  const std::shared_ptr<const localization::StoredMap> map = made.stored();
  RevisitRun run;
  run.first_scan = first;
  run.map_stops = map->maps.size();
  localization::InProcessPool pool;
  localization::MapTracker tracker(config.localizer, map, pool);
  pipeline::LocalMapper mapper(config.local_mapper, "robot");
  double path_m = 0.0;
  std::size_t end = first;
  const auto add = [&](std::optional<topomap::LocalMap> stop) {
    if (!stop) return;
    const std::size_t scan = first + stop->sequence;
    const double before_s = support::process_cpu_s();
    tracker.add(std::make_shared<const topomap::LocalMap>(std::move(*stop)));
    const double step_ms = 1e3 * (support::process_cpu_s() - before_s);
    if (!recording.T_world_robot[scan]) return;
    const Pose2 truth = truth_in(*map, made, *recording.T_world_robot[scan]);
    const localization::LocalizedStop& last = tracker.stops().back();
    run.stops.push_back({scan, path_m, last.status.state, last.T_map_robot, truth,
                         (last.T_map_robot.position_m() - truth.position_m()).norm(), step_ms});
  };
  while (end < std::min(recording.scans.size(), first + options.scans)) {
    if (end > first) {
      path_m += (recording.scans[end].T_odom_robot.position_m() -
                 recording.scans[end - 1].T_odom_robot.position_m())
                    .norm();
    }
    scan::Scan scan = recording.scans[end];
    scan.sequence = end - first;
    add(mapper.add(scan));
    ++end;
  }
  add(mapper.finish());
  return run;
}

}  // namespace

std::optional<double> RevisitRun::found_m() const {
  for (const RevisitStop& stop : stops) {
    if (stop.state == LocalizationState::kTracking && stop.off_m <= kWrong_m) return stop.path_m;
  }
  return std::nullopt;
}

std::size_t RevisitRun::tracking() const {
  return static_cast<std::size_t>(std::count_if(
      stops.begin(), stops.end(),
      [](const RevisitStop& stop) { return stop.state == LocalizationState::kTracking; }));
}

std::size_t RevisitRun::wrong() const {
  return static_cast<std::size_t>(
      std::count_if(stops.begin(), stops.end(), [](const RevisitStop& stop) {
        return stop.state == LocalizationState::kTracking && stop.off_m > kWrong_m;
      }));
}

std::vector<std::size_t> revisits_of(const Recording& recording, const RevisitOptions& options) {
  std::vector<std::size_t> found;
  const std::size_t count = recording.scans.size();
  for (std::size_t i = kFirst; i + options.scans < count;) {
    if (!was_here(recording, i, i - kOlder)) {
      ++i;
      continue;
    }
    std::size_t known = 0;
    for (std::size_t k = i; k < i + options.scans; ++k) {
      known += was_here(recording, k, i - kOlder) ? 1 : 0;
    }
    const bool goes_on = was_here(recording, i + options.scans - 1, i - kOlder) ||
                         static_cast<double>(known) >= kGoesOn * static_cast<double>(options.scans);
    if (!goes_on) {
      ++i;
      continue;
    }
    found.push_back(i);
    i += options.scans;
  }
  return found;
}

std::vector<RevisitRun> run_revisits(const Recording& recording, const pipeline::Config& config,
                                     const RevisitOptions& options) {
  const std::vector<std::size_t> revisits = revisits_of(recording, options);
  const std::size_t count = std::min(options.most, revisits.size());
  std::vector<RevisitRun> runs;
  GrowingStoredMap map(recording, config);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t first = revisits[i * revisits.size() / count];
    map.grow(first - kLeftOut);
    runs.push_back(drive(recording, config, options, map, first));
  }
  return runs;
}

}  // namespace topogeo::bench
