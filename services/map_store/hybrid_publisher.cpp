#include "hybrid_publisher.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>

namespace topogeo::map_store {

namespace {

/// Versions also grow across restarts: a reader may still have tiles of the previous map store.
std::uint64_t first_version() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::milliseconds>(now).count());
}

}  // namespace

HybridPublisher::HybridPublisher(service::Service& service, planning::RoomMemory rooms)
    : service_(service),
      rooms_(std::move(rooms)),
      updates_(service.robot_id(), first_version()),
      tiles_(service.advertise<msg::GridTile>()),
      summaries_(service.advertise<msg::HybridMap>()) {}

void HybridPublisher::publish(const pipeline::HybridMapParts& parts, std::int64_t stamp_ns) {
  if (!pipeline::has_grid(parts)) return;
  try {
    publish(pipeline::make_hybrid_map(parts, service_.setup().config.config.hybrid_map, &rooms_),
            stamp_ns);
  } catch (const std::invalid_argument& error) {
    service_.status().fault("hybrid map not made", error.what());
  }
}

void HybridPublisher::publish(const planning::HybridMap& map, std::int64_t stamp_ns) {
  rest_ = updates_.update_to(map, stamp_ns);
  std::ranges::reverse(rest_.changed);  // sent from the back
  messaging::StatusPublisher& status = service_.status();
  status.set_counter("hybrid_zones", static_cast<double>(map.zones().zones.size()));
  status.set_counter("hybrid_nodes", static_cast<double>(map.nodes().size()));
  status.set_counter("places", static_cast<double>(map.places().size()));
  if (!rest_.empty()) status.add_to_counter("hybrid_updates");
  send_rest();
}

bool HybridPublisher::send_rest() {
  while (!rest_.gone.empty()) {
    tiles_.dispose(rest_.gone.back());
    updates_.disposed(rest_.gone.back());
    rest_.gone.pop_back();
  }
  while (!rest_.changed.empty()) {
    if (!tiles_.write(rest_.changed.back())) {
      service_.status().fault("grid tile not sent", std::to_string(rest_.changed.back().tile()));
      return false;
    }
    updates_.sent(rest_.changed.back());
    rest_.changed.pop_back();
  }
  if (rest_.summary) {
    if (!summaries_.write(*rest_.summary)) {
      service_.status().fault("hybrid map not sent", std::to_string(rest_.summary->version()));
      return false;
    }
    updates_.sent(*rest_.summary);
    rest_.summary.reset();
  }
  service_.status().set_counter("grid_tiles_sent", static_cast<double>(updates_.count()));
  return true;
}

}  // namespace topogeo::map_store
