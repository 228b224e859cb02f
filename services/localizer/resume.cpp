#include "resume.hpp"

#include <exception>
#include <utility>

#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::localizer {

namespace {

// Adding them again takes a second or two, and the time grows with the stops.
constexpr std::uint32_t kMostAddedAgain = 400;

}  // namespace

Resume::Resume(service::Service& service, bool exact, Handler on_ready)
    : service_(service),
      exact_(exact),
      on_ready_(std::move(on_ready)),
      client_(service, [this](const msg::StoredMap& stored) { on_stored(stored); }) {
  service_.status().wait_for("the map store");
}

void Resume::on_stored(const msg::StoredMap& stored) {
  if (stored_) return;
  stored_ = stored;
  if (stored.stops() == 0 && stored.session_stops() == 0) {
    on_ready_({});
  } else if (stored.earlier_stops() == 0 && (exact_ || stored.session_stops() <= kMostAddedAgain)) {
    get_stops(0);
  } else {
    get_map();
  }
}

void Resume::get_map() {
  client_.request(msg::kSnapshotMap, 0, 0, [this](const auto& answer) { on_map(answer); });
}

void Resume::get_stops(std::uint32_t first) {
  if (first >= stored_->session_stops()) {
    on_ready_(std::move(from_));
    return;
  }
  client_.request(msg::kSnapshotLocalMaps, stored_->session(), first,
                  [this](const auto& answer) { on_stops(answer); });
}

bool Resume::usable(const service::StoreClient::Answer& answer) {
  if (answer.bytes) return true;
  service_.status().fault("no snapshot", answer.why);
  stored_.reset();  // the next message of the store sets it again
  from_ = {};
  return false;
}

void Resume::on_map(const service::StoreClient::Answer& answer) {
  if (!usable(answer)) return;
  try {
    storage::MapDocument document = storage::parse_map_file(*answer.bytes, "snapshot");
    document.local_maps.resize(document.trajectory.stops.size());
    std::uint32_t first = 0;
    if (!document.local_maps.empty()) {
      const topomap::StopId last = document.local_maps.back().stop;
      from_.resumes_session = last.session == stored_->session();
      if (from_.resumes_session) first = last.number + 1;
      from_.map = pipeline::stored_map(document);
    }
    get_stops(first);
  } catch (const std::exception& error) {
    usable({std::nullopt, error.what()});
  }
}

void Resume::on_stops(const service::StoreClient::Answer& answer) {
  if (!usable(answer)) return;
  try {
    std::vector<topomap::LocalMap> stops = storage::parse_local_maps(*answer.bytes, "snapshot");
    // A long drive has dropped views that others show as well.
    if (!from_.map && stops.size() < stored_->session_stops()) {
      get_map();
      return;
    }
    for (topomap::LocalMap& map : stops) {
      from_.stops.push_back(std::make_shared<const topomap::LocalMap>(std::move(map)));
    }
    on_ready_(std::move(from_));
  } catch (const std::exception& error) {
    usable({std::nullopt, error.what()});
  }
}

}  // namespace topogeo::localizer
