#include "map_server.hpp"

#include <chrono>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::map_store {

namespace {

/// Parts that did not fit into a history are retried after this time, when readers have probably
/// made room.
constexpr std::chrono::milliseconds kServerRetryPeriod{500};
constexpr std::chrono::milliseconds kServerSnapshotPeriod{40};
constexpr std::chrono::milliseconds kServerSnapshotSlice{20};

}  // namespace

MapServer::MapServer(service::Service& service, storage::MapDocument document,
                     const planning::HybridMap& hybrid)
    : service_(service),
      document_(std::move(document)),
      elements_(service),
      hybrid_(service, document_.rooms),
      stored_out_(service.advertise<msg::StoredMap>()),
      pieces_out_(service.advertise<msg::SnapshotPiece>()),
      snapshots_(
          service.robot_id(),
          [this](const msg::SnapshotRequest& request, const SnapshotQueue::Sink& sink) {
            if (request.kind() == msg::kSnapshotMap) sink(storage::map_file_bytes(document_));
          },
          [this](const msg::SnapshotPiece& piece) { return pieces_out_.write(piece); }),
      copies_(
          service, {}, [] {}, [](const std::string&) {}),
      drawing_(service, document_.drawing, false,
               service.setup().config.config.hybrid_map.grid.resolution_m,
               [this](storage::MapDrawing drawing) {
                 document_.drawing = std::move(drawing);
                 hybrid_.publish(pipeline::parts_of(document_), stamp_ns_);
               }) {
  if (!document_.local_maps.empty()) stamp_ns_ = document_.local_maps.back().stamp_ns;
  hybrid_.publish(hybrid, stamp_ns_);
  drawing_.publish(stamp_ns_);
  send();
  service_.subscribe<msg::SnapshotRequest>(
      [this](const msg::SnapshotRequest& request) { snapshots_.add(request); });
  service_.loop().add_timer(kServerSnapshotPeriod, [this] {
    snapshots_.work(std::chrono::steady_clock::now(), kServerSnapshotSlice);
  });
  service_.loop().add_timer(kServerRetryPeriod, [this] { send(); });
  service_.status().set_counter("local_maps", static_cast<double>(document_.local_maps.size()));
  service_.status().set_state(msg::kServiceRunning);
  spdlog::info("serves a map of {} local maps, {} zones and {} places", document_.local_maps.size(),
               hybrid.zones().zones.size(), hybrid.places().size());
}

// Announces that no session is stored: a local mapper then begins a new one and keeps little of it.
void MapServer::announce() {
  msg::StoredMap message;
  messaging::set_header(message, service_.robot_id(), stamp_ns_, 0);
  message.map_id(document_.map_id);
  message.stops(static_cast<std::uint32_t>(document_.trajectory.stops.size()));
  message.earlier_stops(message.stops());
  message.session(msg::kNothingIsStored);
  announced_ = stored_out_.write(message);
}

void MapServer::send() {
  if (!announced_) announce();
  if (!elements_sent_) {
    elements_sent_ = elements_.publish(document_.global_map, document_.map_id, stamp_ns_);
  }
  hybrid_.send_rest();
}

}  // namespace topogeo::map_store
