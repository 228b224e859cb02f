#include "topogeo/session/kept_views.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "topogeo/matching/expected_overlap.hpp"
#include "topogeo/matching/match_features.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// Distance between stops of one path: another drive along it has a nearer stop.
constexpr double kNear_m = 1.0;
// Share of a view that another must show to replace it. An open door shows more than the rest.
constexpr double kSeen = 0.8;
// Vanished points, 0.2 m apart, that make a view outdated: a cupboard has as many, a person fewer.
constexpr std::uint32_t kGonePoints = 4;
constexpr double kGoneTolerance_m = 0.3;
constexpr std::int64_t kOneTime_ns = 3'600'000'000'000;
// Enough measurements to hold a stop, as in a single drive.
constexpr std::uint32_t kEnoughEdges = 6;

/// Data of a stop for the comparison.
struct View {
  Pose2 T_map_robot;
  std::vector<SurfacePoint> points;
  std::vector<SurfacePoint> outline;
  RangeProfile profile;
  std::uint32_t drive = 0;
  std::uint32_t time = 0;

  /// Whether this view includes the area of the other one, whatever is there now.
  [[nodiscard]] bool covers(const View& other) const {
    const Pose2 T_this_other = geometry::between(T_map_robot, other.T_map_robot);
    if (T_this_other.position_m().squaredNorm() > kNear_m * kNear_m) return false;
    return expected_overlap(profile, other.outline, {T_this_other, Eigen::Matrix3d::Zero()},
                            kSeen) >= kSeen;
  }

  /// The second condition is for walls seen at a flat angle.
  [[nodiscard]] bool shows_nothing_at(const Eigen::Vector2d& point_m) const {
    constexpr double kSquared_m2 = kGoneTolerance_m * kGoneTolerance_m;
    return profile.view(point_m, kGoneTolerance_m) == RangeProfile::View::kFree &&
           std::ranges::none_of(points, [&](const SurfacePoint& own) {
             return (own.position_m - point_m).squaredNorm() < kSquared_m2;
           });
  }
};

/// Whether another drive begins at a stop.
bool begins_drive(std::span<const topomap::LocalMap> maps, std::size_t stop,
                  std::uint32_t stops_of_drive) {
  const topomap::StopId& here = maps[stop].stop;
  const topomap::StopId& before = maps[stop - 1].stop;
  return here.session != before.session ||
         here.number / stops_of_drive != before.number / stops_of_drive;
}

bool one_drive(std::span<const topomap::LocalMap> maps, std::uint32_t stops_of_drive) {
  for (std::size_t i = 1; i < maps.size(); ++i) {
    if (begins_drive(maps, i, stops_of_drive)) return false;
  }
  return true;
}

/// Assigns a drive and a time to each stop.
void count_drives(std::span<const topomap::LocalMap> maps, std::uint32_t stops_of_drive,
                  std::vector<View>& views) {
  std::uint32_t drive = 0;
  std::uint32_t time = 0;
  std::int64_t time_began_ns = maps.front().stamp_ns;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    if (i > 0 && begins_drive(maps, i, stops_of_drive)) {
      ++drive;
      const std::int64_t stamp_ns = maps[i].stamp_ns;
      if (stamp_ns < time_began_ns || stamp_ns > time_began_ns + kOneTime_ns) {
        ++time;
        time_began_ns = stamp_ns;
      }
    }
    views[i].drive = drive;
    views[i].time = time;
  }
}

std::vector<View> views_of(std::span<const topomap::LocalMap> maps,
                           std::span<const topomap::StopPose> stops, std::uint32_t stops_of_drive) {
  std::vector<View> views(maps.size());
  for (std::size_t i = 0; i < maps.size(); ++i) {
    MatchFeatures features = extract_scan_features(maps[i].points, maps[i].T_robot_laser);
    views[i].T_map_robot = stops[i].T_map_robot;
    views[i].outline = outline_of(features.coarse);
    views[i].points = std::move(features.coarse);
    views[i].profile = std::move(features.profile);
  }
  count_drives(maps, stops_of_drive, views);
  return views;
}

/// Decides stop by stop, starting with the oldest.
class Choice {
 public:
  Choice(std::vector<View> views, std::size_t times)
      : views_(std::move(views)), times_(times), oldest_(views_.size(), false) {}

  struct Verdict {
    std::optional<std::uint32_t> by;  ///< the stop that replaces it; empty: kept
    bool outdated = false;
  };
  Verdict judge(std::uint32_t stop) {
    if (const auto same = of_this_time(stop)) return {same, false};
    const std::vector<std::uint32_t> later = last_times(later_views(stop));
    if (times(later) < times_) return {};
    if (gone(stop, later)) return {later.back(), true};
    for (std::uint32_t other = 0; other < stop; ++other) {
      if (oldest_[other] && views_[other].drive != views_[stop].drive &&
          views_[other].covers(views_[stop])) {
        return {other, false};
      }
    }
    oldest_[stop] = true;
    return {};
  }

 private:
  /// A view of an earlier drive at the same time.
  [[nodiscard]] std::optional<std::uint32_t> of_this_time(std::uint32_t stop) const {
    const View& view = views_[stop];
    for (std::uint32_t other = stop; other-- > 0 && views_[other].time == view.time;) {
      if (views_[other].drive != view.drive && views_[other].covers(view)) return other;
    }
    return std::nullopt;
  }

  /// Views of later times that cover the stop, ascending.
  [[nodiscard]] std::vector<std::uint32_t> later_views(std::uint32_t stop) const {
    std::vector<std::uint32_t> later;
    for (std::uint32_t other = stop + 1; other < views_.size(); ++other) {
      if (views_[other].time != views_[stop].time && views_[other].covers(views_[stop])) {
        later.push_back(other);
      }
    }
    return later;
  }

  [[nodiscard]] std::size_t times(std::span<const std::uint32_t> stops) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < stops.size(); ++i) {
      if (i == 0 || views_[stops[i]].time != views_[stops[i - 1]].time) ++count;
    }
    return count;
  }

  /// The last of these, as many times as are kept.
  [[nodiscard]] std::vector<std::uint32_t> last_times(std::vector<std::uint32_t> stops) const {
    std::size_t first = stops.size();
    for (std::size_t count = 0; first > 0; --first) {
      const bool another =
          first == stops.size() || views_[stops[first - 1]].time != views_[stops[first]].time;
      if (another && ++count > times_) break;
    }
    stops.erase(stops.begin(), stops.begin() + static_cast<std::ptrdiff_t>(first));
    return stops;
  }

  /// Whether several points of the stop's view are gone in each of the last times: a person leaves,
  /// a door opens and shuts.
  [[nodiscard]] bool gone(std::uint32_t stop, std::span<const std::uint32_t> later) const {
    const View& view = views_[stop];
    std::vector<std::set<std::uint32_t>> missed(view.points.size());  // times without the point
    for (const std::uint32_t other : later) {
      const Pose2 T_other_stop = geometry::between(views_[other].T_map_robot, view.T_map_robot);
      const geometry::SinCos heading = geometry::sincos(T_other_stop.theta_rad);
      for (std::size_t i = 0; i < view.points.size(); ++i) {
        const SurfacePoint p = moved(view.points[i], T_other_stop, heading);
        if (views_[other].shows_nothing_at(p.position_m)) missed[i].insert(views_[other].time);
      }
    }
    const auto count =
        std::ranges::count_if(missed, [&](const auto& at) { return at.size() >= times_; });
    return count >= kGonePoints;
  }

  std::vector<View> views_;
  std::size_t times_;
  std::vector<bool> oldest_;  // kept despite enough later views
};

}  // namespace

KeptViews::KeptViews(std::span<const topomap::LocalMap> maps,
                     std::span<const topomap::StopPose> stops, std::size_t times,
                     std::size_t untouched, std::uint32_t stops_of_drive)
    : stops_(maps.size()), new_ids_(maps.size()) {
  // A single drive loses no view.
  const std::size_t last = maps.empty() || one_drive(maps, stops_of_drive)
                               ? 0
                               : maps.size() - std::min(untouched, maps.size());
  Choice choice(last > 0 ? views_of(maps, stops, stops_of_drive) : std::vector<View>{}, times);
  for (std::uint32_t i = 0; i < maps.size(); ++i) {
    const Choice::Verdict verdict = i > 0 && i < last ? choice.judge(i) : Choice::Verdict{};
    stops_[i] = {verdict.by.value_or(i), verdict.outdated};
    if (verdict.by) continue;
    new_ids_[i] = static_cast<std::uint32_t>(kept_.size());
    kept_.push_back(i);
  }
  // A replacement may itself have been replaced by a view of a later time or of its own.
  for (Stop& stop : stops_) {
    while (stops_[stop.by].by != stop.by) stop.by = stops_[stop.by].by;
  }
}

topomap::Trajectory kept_trajectory(const topomap::Trajectory& trajectory, const KeptViews& kept) {
  topomap::Trajectory out;
  out.version = trajectory.version + 1;
  out.numbered_since = out.version;
  for (const std::uint32_t stop : kept.kept()) {
    out.stops.push_back(trajectory.stops[stop]);
    out.stops.back().local_map_id = kept.new_id(stop);
  }
  for (std::uint32_t i = 0; i < trajectory.stops.size(); ++i) {
    if (kept.is_kept(i) || kept.outdated(i)) continue;
    topomap::StopPose& stands = out.stops[kept.new_id(i)];
    stands.views += trajectory.stops[i].views;
    stands.last_view_ns = std::max(stands.last_view_ns, trajectory.stops[i].last_seen_ns());
  }
  return out;
}

std::vector<topomap::LocalMap> kept_maps(std::span<const topomap::LocalMap> maps,
                                         const KeptViews& kept) {
  std::vector<topomap::LocalMap> out;
  for (const std::uint32_t stop : kept.kept()) {
    const auto id = static_cast<std::uint32_t>(out.size());
    const bool follows = id == 0 || out.back().stop.next() == maps[stop].stop;
    out.push_back(topomap::numbered(maps[stop], id, !follows));
  }
  return out;
}

std::vector<PoseGraphEdge> kept_edges(std::span<const PoseGraphEdge> edges,
                                      std::span<const topomap::LocalMap> maps,
                                      std::span<const topomap::StopPose> stops,
                                      const KeptViews& kept) {
  std::vector<PoseGraphEdge> out;
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  std::vector<std::uint32_t> of_stop(kept.kept().size());
  const auto add = [&](const PoseGraphEdge& edge) {
    pairs.insert({edge.from, edge.to});
    ++of_stop[edge.from];
    ++of_stop[edge.to];
    out.push_back(edge);
  };
  for (PoseGraphEdge edge : edges) {
    if (!kept.is_kept(edge.from) || !kept.is_kept(edge.to)) continue;
    edge.from = kept.new_id(edge.from);
    edge.to = kept.new_id(edge.to);
    add(edge);
  }
  // Edges for dropped stops, by the current poses: matches led to the dropped stop and on from
  // there.
  const Eigen::Matrix3d more = 2.0 * usual_match_covariance();
  for (const PoseGraphEdge& edge : edges) {
    if (edge.kind == EdgeKind::kOdometry) continue;
    if (kept.is_kept(edge.from) && kept.is_kept(edge.to)) continue;
    const auto [a, b] = std::minmax({kept.stands_for(edge.from), kept.stands_for(edge.to)});
    if (a == b || maps[a].stop.next() == maps[b].stop) continue;
    const std::pair ids(kept.new_id(a), kept.new_id(b));
    const bool enough = of_stop[ids.first] >= kEnoughEdges && of_stop[ids.second] >= kEnoughEdges;
    if (enough || pairs.contains(ids)) continue;
    add({ids.first, ids.second, EdgeKind::kRevisit,
         geometry::between(stops[a].T_map_robot, stops[b].T_map_robot), edge.covariance + more});
  }
  return out;
}

StoredMap with_kept_views(const StoredMap& map, const KeptViews& kept) {
  StoredMap out;
  out.maps = kept_maps(map.maps, kept);
  out.trajectory = kept_trajectory(map.trajectory, kept);
  out.edges = kept_edges(edges_of(map), map.maps, map.trajectory.stops, kept);
  for (const PoseGraphEdge& edge : out.edges) {
    if (edge.kind != EdgeKind::kRevisit) continue;
    out.loop_closures.push_back({edge.from, edge.to, edge.T_from_to});
  }
  if (map.edges.empty()) out.edges.clear();  // measurements stay unknown
  return out;
}

}  // namespace topogeo::localization
