#include "shared_resume.hpp"

#include <algorithm>
#include <exception>
#include <tuple>
#include <utility>

#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/session/mapping_session.hpp"
#include "topogeo/storage/map_file.hpp"

namespace topogeo::localizer {

SharedResume::SharedResume(service::Service& service, Handler on_ready)
    : service_(service),
      on_ready_(std::move(on_ready)),
      client_(service, [this](const msg::StoredMap& stored) { on_stored(stored); }) {
  service_.status().wait_for("the map store");
}

void SharedResume::on_stored(const msg::StoredMap& stored) {
  if (begun_) return;
  stored_[stored.robot_id().to_string()] = stored;
  if (stored_.size() <= service_.setup().options.other_robots.size()) return;
  begun_ = true;
  for (const auto& [robot, state] : stored_) {
    if (state.session_stops() > 0) sessions_.push_back(state);
  }
  if (stored.stops() == 0) {
    get_stops();
  } else {
    client_.request(msg::kSnapshotMap, 0, 0, [this](const auto& answer) { on_map(answer); });
  }
}

bool SharedResume::usable(const service::StoreClient::Answer& answer) {
  if (answer.bytes) return true;
  service_.status().fault("no snapshot", answer.why);
  stored_.clear();  // the next messages of the store set it again
  sessions_.clear();
  from_ = {};
  begun_ = false;
  return false;
}

void SharedResume::on_map(const service::StoreClient::Answer& answer) {
  if (!usable(answer)) return;
  try {
    storage::MapDocument document = storage::parse_map_file(*answer.bytes, "snapshot");
    from_.refused_merges = std::move(document.refused_merges);
    document.local_maps.resize(document.trajectory.stops.size());
    if (!document.local_maps.empty()) from_.map = pipeline::stored_map(document);
    get_stops();
  } catch (const std::exception& error) {
    usable({std::nullopt, error.what()});
  }
}

void SharedResume::get_stops() {
  if (sessions_.empty()) {
    std::ranges::stable_sort(from_.stops, [](const auto& a, const auto& b) {
      return std::tie(a->stamp_ns, a->robot_id, a->stop) <
             std::tie(b->stamp_ns, b->robot_id, b->stop);
    });
    on_ready_(std::move(from_));
    return;
  }
  const std::uint64_t session = sessions_.back().session();
  std::uint32_t first = 0;
  if (from_.map) {
    for (const topomap::LocalMap& map : from_.map->maps) {
      if (map.stop.session == session) first = std::max(first, map.stop.number + 1);
    }
  }
  if (first >= sessions_.back().session_stops()) {
    sessions_.pop_back();
    get_stops();
    return;
  }
  client_.request(msg::kSnapshotLocalMaps, session, first,
                  [this](const auto& answer) { on_stops(answer); });
}

void SharedResume::on_stops(const service::StoreClient::Answer& answer) {
  if (!usable(answer)) return;
  try {
    std::vector<topomap::LocalMap> stops = storage::parse_local_maps(*answer.bytes, "snapshot");
    // A session that has waited long to join needs only its newest stops.
    const std::size_t most = localization::MappingSession::kMostWaiting;
    const std::size_t first = stops.size() > most ? stops.size() - most : 0;
    for (std::size_t i = first; i < stops.size(); ++i) {
      from_.stops.push_back(std::make_shared<const topomap::LocalMap>(std::move(stops[i])));
    }
    sessions_.pop_back();
    get_stops();
  } catch (const std::exception& error) {
    usable({std::nullopt, error.what()});
  }
}

}  // namespace topogeo::localizer
