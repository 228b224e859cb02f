#include "topogeo/exchange/sessions.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <stdexcept>

#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/slam/pose_graph.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::exchange {
namespace {

constexpr std::int64_t kRemoved = -1;

/// The pairs of stops that both remain, with their new ids.
template <typename Pair>
std::vector<Pair> kept_pairs(const std::vector<Pair>& pairs,
                             const std::vector<std::int64_t>& new_ids) {
  std::vector<Pair> kept;
  for (Pair pair : pairs) {
    const std::int64_t earlier = new_ids[pair.earlier_id];
    const std::int64_t later = new_ids[pair.later_id];
    if (earlier == kRemoved || later == kRemoved) continue;
    pair.earlier_id = static_cast<std::uint32_t>(earlier);
    pair.later_id = static_cast<std::uint32_t>(later);
    kept.push_back(pair);
  }
  return kept;
}

/// Sets the poses that the measurements alone give.
void optimize_poses(storage::MapDocument& document) {
  localization::PoseGraph graph;
  for (const topomap::StopPose& stop : document.trajectory.stops) graph.add_pose(stop.T_map_robot);
  for (const auto& edge : pipeline::pose_graph_edges(document.edges)) {
    if (edge.to < document.trajectory.stops.size()) graph.add_edge(edge);
  }
  if (!graph.optimize().usable) return;
  for (topomap::StopPose& stop : document.trajectory.stops) {
    if (stop.located) stop.T_map_robot = graph.poses()[stop.local_map_id];
  }
}

}  // namespace

std::vector<SessionSummary> sessions_of(const storage::MapDocument& document) {
  std::vector<SessionSummary> sessions;
  for (const topomap::LocalMap& map : document.local_maps) {
    auto at = std::ranges::find(sessions, map.stop.session, &SessionSummary::session);
    if (at == sessions.end()) {
      sessions.push_back({map.stop.session, 0, map.id, map.stamp_ns, map.stamp_ns});
      at = sessions.end() - 1;
    }
    ++at->stops;
    at->first_stamp_ns = std::min(at->first_stamp_ns, map.stamp_ns);
    at->last_stamp_ns = std::max(at->last_stamp_ns, map.stamp_ns);
  }
  return sessions;
}

std::string session_text(std::uint64_t session) {
  return fmt::format("{:016x}", session);
}

std::optional<std::uint64_t> session_of_text(std::string_view text) {
  constexpr int kHexadecimal = 16;
  std::uint64_t session = 0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), session, kHexadecimal);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return session;
}

storage::MapDocument without_session(const storage::MapDocument& document, std::uint64_t session,
                                     const topomap::GlobalMapConfig& config) {
  storage::MapDocument out;
  out.robot_id = document.robot_id;
  out.seed = document.seed;
  out.map_id = document.map_id;
  out.drawing = document.drawing;
  out.rooms = document.rooms;
  std::ranges::copy_if(document.refused_merges, std::back_inserter(out.refused_merges),
                       [&](const storage::RefusedMerge& refused) {
                         return refused.stop.session != session && refused.other.session != session;
                       });
  std::vector<std::int64_t> new_ids(document.local_maps.size(), kRemoved);
  for (std::size_t i = 0; i < document.local_maps.size(); ++i) {
    const topomap::LocalMap& map = document.local_maps[i];
    if (map.stop.session == session) continue;
    const auto id = static_cast<std::uint32_t>(out.local_maps.size());
    new_ids[i] = id;
    const bool follows = i > 0 && new_ids[i - 1] != kRemoved;
    out.local_maps.push_back(topomap::numbered(map, id, id > 0 && !follows));
    if (i < document.trajectory.stops.size()) {
      out.trajectory.stops.push_back(document.trajectory.stops[i]);
      out.trajectory.stops.back().local_map_id = id;
    }
  }
  if (out.local_maps.size() == document.local_maps.size() || out.local_maps.empty()) {
    throw std::invalid_argument(
        fmt::format("session {}: expected one of several in the map, {}", session_text(session),
                    out.local_maps.empty() ? "all stops belong to it" : "no stop belongs to it"));
  }
  out.loop_closures = kept_pairs(document.loop_closures, new_ids);
  out.edges = kept_pairs(document.edges, new_ids);
  out.trajectory.version = document.trajectory.version + 1;
  out.trajectory.numbered_since = out.trajectory.version;
  if (!out.edges.empty()) optimize_poses(out);
  out.global_map = pipeline::fuse(config, out.local_maps, out.trajectory);
  return out;
}

}  // namespace topogeo::exchange
