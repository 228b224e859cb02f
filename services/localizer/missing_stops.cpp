#include "missing_stops.hpp"

#include <exception>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::localizer {

MissingStops::MissingStops(service::Service& service, StopQueue& queue, bool ask,
                           std::function<void()> on_change)
    : service_(service), queue_(queue), ask_(ask), on_change_(std::move(on_change)) {}

void MissingStops::check() {
  if (asking_) return;
  const std::optional<topomap::StopId> before = std::exchange(missing_, queue_.missing());
  if (!missing_ && ask_) missing_ = queue_.missing_at_end();
  // Only after two equal checks: a map that came meanwhile is in the queue.
  if (!missing_ || missing_ != before) return;
  if (!ask_) {
    skip();
    return;
  }
  if (!store_) store_.emplace(service_, [](const msg::StoredMap&) {});
  asking_ = true;
  spdlog::info("requesting the stops from number {} on from the map store", missing_->number);
  store_->request(msg::kSnapshotLocalMaps, missing_->session, missing_->number,
                  [this](const auto& answer) { on_answer(answer); });
}

void MissingStops::on_answer(const service::StoreClient::Answer& answer) {
  asking_ = false;
  try {
    if (answer.bytes) {
      for (topomap::LocalMap& map : storage::parse_local_maps(*answer.bytes, "snapshot")) {
        if (queue_.arrival(map.stop, topomap::content_hash(map)) != StopQueue::Arrival::kNew) {
          continue;
        }
        queue_.add(std::make_shared<const topomap::LocalMap>(std::move(map)));
      }
    }
  } catch (const std::exception& error) {
    service_.status().fault("no snapshot", error.what());
    return;  // the next checks ask again
  }
  if (queue_.missing() == missing_) {
    skip();
  } else {
    on_change_();
  }
}

void MissingStops::skip() {
  const topomap::StopId missing = *missing_;
  missing_.reset();
  if (missing.number > 0) {
    service_.status().fault(
        "local maps missing",
        fmt::format("stop {} is missing: the session cannot continue", missing.number));
    return;
  }
  const topomap::StopId first = queue_.begin_late(missing.session);
  if (ask_) {
    service_.status().fault(
        "local maps missing",
        fmt::format("stops 0 to {} are missing: beginning after them", first.number - 1));
  }
  on_change_();
}

}  // namespace topogeo::localizer
