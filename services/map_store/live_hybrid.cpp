#include "live_hybrid.hpp"

#include <algorithm>

namespace topogeo::map_store {

namespace {

// The map is made in one go, which may take long: at most a tenth of the time.
constexpr std::chrono::seconds kHybridPeriod{4};
constexpr int kHybridShare = 10;

}  // namespace

LiveHybrid::LiveHybrid(service::Service& service, planning::RoomMemory rooms,
                       std::optional<topomap::GlobalMap> map)
    : publisher_(service, std::move(rooms)), map_(std::move(map)), due_(map_.has_value()) {}

void LiveHybrid::take(topomap::GlobalMap map) {
  map_ = std::move(map);
  due_ = true;
}

void LiveHybrid::redraw() {
  if (!map_) map_.emplace();
  due_ = true;
  next_ = {};
}

bool LiveHybrid::due() {
  publisher_.send_rest();
  return due_ && Clock::now() >= next_;
}

void LiveHybrid::make(pipeline::HybridMapParts parts, std::int64_t stamp_ns) {
  const auto start = Clock::now();
  parts.global_map = &*map_;
  publisher_.publish(parts, stamp_ns);
  due_ = false;
  const auto end = Clock::now();
  next_ = end + std::max<Clock::duration>(kHybridPeriod, kHybridShare * (end - start));
}

void LiveHybrid::finish(const pipeline::HybridMapParts& parts, std::int64_t stamp_ns) {
  publisher_.publish(parts, stamp_ns);
  map_ = *parts.global_map;
  due_ = false;
}

}  // namespace topogeo::map_store
