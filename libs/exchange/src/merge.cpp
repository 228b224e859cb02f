#include "topogeo/exchange/merge.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <set>
#include <stdexcept>
#include <utility>

#include "topogeo/exchange/place_graph.hpp"
#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/matching/matcher.hpp"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/session/mapping_session.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/hash.hpp"

namespace topogeo::exchange {
namespace {

using geometry::Pose2;
using topomap::LocalMap;
using topomap::StopPose;

std::uint64_t hash_of_stops(const storage::MapDocument& document) {
  support::Fnv1a hash;
  for (const LocalMap& map : document.local_maps) hash.add(topomap::content_hash(map));
  return hash.value();
}

/// Whether `a` is the map that is continued.
bool comes_first(const storage::MapDocument& a, const storage::MapDocument& b) {
  if (a.local_maps.size() != b.local_maps.size()) {
    return a.local_maps.size() > b.local_maps.size();
  }
  return hash_of_stops(a) < hash_of_stops(b);
}

void check_sessions(const storage::MapDocument& a, const storage::MapDocument& b) {
  std::set<std::uint64_t> sessions;
  for (const LocalMap& map : a.local_maps) sessions.insert(map.stop.session);
  sessions.erase(0);  // older files do not name sessions
  for (const LocalMap& map : b.local_maps) {
    if (!sessions.contains(map.stop.session)) continue;
    throw std::invalid_argument(
        fmt::format("both maps have stops of session {:016x}: one is an earlier state of the other",
                    map.stop.session));
  }
}

/// The stops with poses, as the map that is continued.
localization::StoredMap stored_part(const storage::MapDocument& document) {
  localization::StoredMap stored;
  std::vector<std::int64_t> new_ids(document.local_maps.size(), -1);
  for (std::size_t i = 0; i < document.trajectory.stops.size(); ++i) {
    if (!document.trajectory.stops[i].located) continue;
    const auto id = static_cast<std::uint32_t>(stored.maps.size());
    new_ids[i] = id;
    const bool follows = i > 0 && new_ids[i - 1] >= 0;
    LocalMap map = document.local_maps[i];
    map.robot_id = "merge";
    stored.maps.push_back(topomap::numbered(std::move(map), id, id > 0 && !follows));
    stored.trajectory.stops.push_back(document.trajectory.stops[i]);
    stored.trajectory.stops.back().local_map_id = id;
  }
  stored.trajectory.version = document.trajectory.version;
  for (const topomap::LoopClosure& loop : document.loop_closures) {
    const std::int64_t earlier = new_ids.at(loop.earlier_id);
    const std::int64_t later = new_ids.at(loop.later_id);
    if (earlier < 0 || later < 0) continue;
    stored.loop_closures.push_back({static_cast<std::uint32_t>(earlier),
                                    static_cast<std::uint32_t>(later), loop.T_earlier_later});
  }
  for (localization::PoseGraphEdge edge : pipeline::pose_graph_edges(document.edges)) {
    if (new_ids.at(edge.from) < 0 || new_ids.at(edge.to) < 0) continue;
    edge.from = static_cast<std::uint32_t>(new_ids[edge.from]);
    edge.to = static_cast<std::uint32_t>(new_ids[edge.to]);
    stored.edges.push_back(edge);
  }
  return stored;
}

/// A series of successive stops with poses.
struct Drive {
  std::vector<std::size_t> stops;  ///< indices in the map
  Pose2 T_map_start;               ///< of the first stop, in its own map
};

std::vector<Drive> drives_of(const storage::MapDocument& document) {
  std::vector<Drive> drives;
  bool follows = false;
  for (std::size_t i = 0; i < document.trajectory.stops.size(); ++i) {
    const StopPose& stop = document.trajectory.stops[i];
    follows = follows && !document.local_maps[i].starts_drive;
    if (stop.located && !follows) drives.push_back({{}, stop.T_map_robot});
    if (stop.located) drives.back().stops.push_back(i);
    follows = stop.located;
  }
  return drives;
}

class Merger {
 public:
  Merger(const storage::MapDocument& base, const storage::MapDocument& other,
         const pipeline::Config& config)
      : base_(base), other_(other), config_(config), map_(stored_part(base)) {
    // The order of the drives replaces the session names, which return at the end.
    for (const LocalMap& map : map_.maps) names_.push_back(map.stop);
  }

  MergedMap run() {
    MergedMap out;
    out.alignment = align(base_, other_);
    if (!out.alignment.found) {
      out.notes.push_back("not aligned: " + out.alignment.reason);
      return out;
    }
    for (const Drive& drive : drives_of(other_)) add(drive, out);
    out.merged = out.joined > 0;
    if (!out.merged) {
      out.notes.emplace_back("no stop of the smaller map joined the other one");
      return out;
    }
    if (out.left_out > 0) {
      out.notes.push_back(
          fmt::format("{} stops were not localized and are left out", out.left_out));
    }
    return out;
  }

  /// The result, in the frame of the map that was continued.
  [[nodiscard]] const localization::StoredMap& map() const { return map_; }
  [[nodiscard]] const std::vector<topomap::StopId>& names() const { return names_; }
  /// Index, within the added map, of its first stop that joined.
  [[nodiscard]] std::size_t first_joined() const { return first_joined_; }

 private:
  void add(const Drive& drive, MergedMap& out) {
    // At least the accuracy of a pose that a person gives, because both maps deform.
    constexpr double kLeast_m = 0.1;
    constexpr double kLeast_rad = 0.03;
    const double sigma_m = std::max(kLeast_m, out.alignment.sigma_m);
    const double sigma_rad = std::max(kLeast_rad, out.alignment.sigma_rad);
    const localization::UncertainPose start{
        out.alignment.T_map_foreign * drive.T_map_start,
        Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal()};
    localization::InProcessPool pool;
    const auto stored = std::make_shared<const localization::StoredMap>(map_);
    localization::MappingSession session(config_.localizer, pool, nullptr, stored, start);
    session.keep_all_views();  // their names here are the stops' indices
    ++drives_;
    for (std::size_t i = 0; i < drive.stops.size(); ++i) {
      auto map = std::make_shared<LocalMap>(other_.local_maps[drive.stops[i]]);
      map->robot_id = "merge";
      map->id = static_cast<std::uint32_t>(i);
      map->stop = {drives_, map->id};
      session.add(std::move(map));
    }
    session.finish();
    const std::size_t before = map_.maps.size();
    const std::size_t after = session.maps().size();
    const bool is_first = out.joined == 0;
    out.joined += after - before;
    out.left_out += drive.stops.size() - (after - before);
    if (after == before) return;
    if (is_first) first_joined_ = drive.stops.at(session.maps()[before]->stop.number);
    localization::StoredMap next;
    for (const auto& map : session.maps()) next.maps.push_back(*map);
    next.trajectory = session.trajectory();
    next.loop_closures = session.loop_closures();
    next.edges = session.edges();
    for (std::size_t i = before; i < after; ++i) {
      names_.push_back(other_.local_maps[drive.stops.at(next.maps[i].stop.number)].stop);
    }
    map_ = std::move(next);
  }

  const storage::MapDocument& base_;
  const storage::MapDocument& other_;
  const pipeline::Config& config_;
  localization::StoredMap map_;
  std::vector<topomap::StopId> names_;  // of the stops of map_ in their own maps
  std::uint64_t drives_ = 0;            // added so far
  std::size_t first_joined_ = 0;
};

void move_poses(topomap::Trajectory& trajectory, const Pose2& T) {
  if (T == Pose2{}) return;
  const auto [sin, cos] = geometry::sincos(T.theta_rad);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << cos, -sin, sin, cos;
  for (StopPose& stop : trajectory.stops) {
    stop.T_map_robot = T * stop.T_map_robot;
    stop.covariance = turn * stop.covariance * turn.transpose();
  }
}

}  // namespace

MergedMap merge(const storage::MapDocument& a, const storage::MapDocument& b,
                const pipeline::Config& config) {
  check_sessions(a, b);
  const bool a_first = comes_first(a, b);
  const storage::MapDocument& base = a_first ? a : b;
  const storage::MapDocument& other = a_first ? b : a;
  Merger merger(base, other, config);
  MergedMap out = merger.run();
  if (!out.merged) return out;
  storage::MapDocument& document = out.document;
  document.robot_id = a.robot_id;
  document.seed = a.seed;
  document.map_id = a.map_id;
  document.local_maps = merger.map().maps;
  document.trajectory = merger.map().trajectory;
  document.loop_closures = merger.map().loop_closures;
  document.edges = pipeline::map_edges(merger.map().edges);
  document.rooms = a.rooms;
  document.refused_merges = a.refused_merges;
  std::ranges::copy(b.refused_merges, std::back_inserter(document.refused_merges));
  for (std::size_t i = 0; i < document.local_maps.size(); ++i) {
    document.local_maps[i].robot_id = a.robot_id;
    document.local_maps[i].stop = merger.names()[i];
    document.trajectory.stops[i].stop = merger.names()[i];
    document.trajectory.stops[i].stamp_ns = document.local_maps[i].stamp_ns;
  }
  // The first stop of `a` keeps its pose in `a`; the first joined stop of the added map comes
  // directly after the earlier ones.
  const std::size_t first_added = document.local_maps.size() - out.joined;
  const Pose2 T_base_other =
      document.trajectory.stops[first_added].T_map_robot *
      geometry::inverse(other.trajectory.stops[merger.first_joined()].T_map_robot);
  const Pose2 T_a_base = a_first ? Pose2{} : geometry::inverse(T_base_other);
  move_poses(document.trajectory, T_a_base);
  MapGraph drawing_of_b;
  drawing_of_b.drawing = b.drawing;
  move(drawing_of_b, a_first ? T_base_other : geometry::inverse(T_base_other));
  document.drawing = std::move(drawing_of_b.drawing);
  pipeline::lay_over(document.drawing, a.drawing);
  document.global_map = pipeline::fuse(config.global_map, document.local_maps, document.trajectory);
  return out;
}

}  // namespace topogeo::exchange
