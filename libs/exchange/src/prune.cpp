#include "topogeo/exchange/prune.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/session/kept_views.hpp"
#include "topogeo/storage/map_database.hpp"

namespace topogeo::exchange {
namespace {

/// Sessions that never joined the map and are old enough.
std::vector<PrunedSession> unjoined_sessions(const storage::MapDatabase& database,
                                             std::int64_t older_ns) {
  const std::vector<storage::SessionState> states = database.sessions();
  std::vector<PrunedSession> sessions;
  std::int64_t newest_ns = 0;
  for (const topomap::StopId& stop : database.waiting_stops()) {
    if (sessions.empty() || sessions.back().session != stop.session) {
      sessions.push_back({stop.session, 0, 0});
    }
    ++sessions.back().stops;
    if (const auto map = database.stop(stop)) sessions.back().last_stamp_ns = map->stamp_ns;
    newest_ns = std::max(newest_ns, sessions.back().last_stamp_ns);
  }
  for (const topomap::StopPose& stop : database.load().trajectory.stops) {
    newest_ns = std::max(newest_ns, stop.stamp_ns);
  }
  std::erase_if(sessions, [&](const PrunedSession& session) {
    const auto state = std::ranges::find(states, session.session, &storage::SessionState::id);
    return state->joined > 0 || session.session == states.back().id ||
           session.last_stamp_ns + older_ns > newest_ns;
  });
  return sessions;
}

}  // namespace

storage::MapDocument with_fewer_views(const storage::MapDocument& document, std::size_t times,
                                      const topomap::GlobalMapConfig& config) {
  const std::size_t located = document.trajectory.stops.size();
  const bool all = std::ranges::all_of(document.trajectory.stops, &topomap::StopPose::located);
  if (!all) return document;  // a drive that was localized in a map is no map itself
  storage::MapDocument with_poses = document;
  with_poses.local_maps.resize(located);
  const auto stored = pipeline::stored_map(with_poses);
  const localization::KeptViews kept(stored->maps, stored->trajectory.stops, times);
  if (kept.dropped() == 0) return document;
  localization::StoredMap fewer = localization::with_kept_views(*stored, kept);
  storage::MapDocument out;
  out.robot_id = document.robot_id;
  out.seed = document.seed;
  out.map_id = document.map_id;
  out.drawing = document.drawing;
  out.rooms = document.rooms;
  out.refused_merges = document.refused_merges;
  out.local_maps = std::move(fewer.maps);
  out.trajectory = std::move(fewer.trajectory);
  out.loop_closures = std::move(fewer.loop_closures);
  out.edges = pipeline::map_edges(fewer.edges);
  out.global_map = pipeline::fuse(config, out.local_maps, out.trajectory);
  return out;
}

Pruned prune(const std::filesystem::path& file, const PruneSettings& settings,
             const topomap::GlobalMapConfig& config) {
  Pruned pruned;
  pruned.bytes_before = storage::database_bytes(file);
  storage::MapDatabase database = settings.dry_run ? storage::MapDatabase::open_read_only(file)
                                                   : storage::MapDatabase::open_existing(file);
  pruned.sessions = unjoined_sessions(database, settings.older_ns);
  pruned.views_before = pruned.views = database.local_map_count();
  std::optional<storage::MapDocument> fewer;
  if (settings.times) {
    fewer = with_fewer_views(database.load(), *settings.times, config);
    pruned.views = fewer->local_maps.size();
  }
  if (!settings.dry_run) {
    for (const PrunedSession& session : pruned.sessions) database.drop_session(session.session);
    if (fewer && pruned.views < pruned.views_before) {
      std::vector<storage::JoinedStop> stops;
      for (const topomap::LocalMap& map : fewer->local_maps) {
        stops.push_back({map.stop, map.starts_drive});
      }
      database.renew(fewer->trajectory, fewer->loop_closures, stops);
      database.put_edges(fewer->edges);
      database.put_global_map(fewer->global_map);
    }
    database.compact();
  }
  pruned.bytes = settings.dry_run ? pruned.bytes_before : storage::database_bytes(file);
  return pruned;
}

}  // namespace topogeo::exchange
