#include "topogeo/service/trajectory_assembly.hpp"

#include <algorithm>

#include "topogeo/service/conversions.hpp"

namespace topogeo::service {

bool TrajectoryAssembly::add(const msg::TrajectorySegment& message) {
  if (message.numbered_since() < numbered_since_) return false;
  if (message.numbered_since() > numbered_since_) {
    static_cast<void>(from_msg(message));  // throws before any segment is dropped
    segments_.clear();
    numbered_since_ = message.numbered_since();
  }
  const auto held = segments_.find(message.segment());
  if (held != segments_.end() && message.version() < held->second.version) return false;
  segments_[message.segment()] = {message.version(), message.total_stops(), from_msg(message)};
  version_ = std::max(version_, message.version());
  return true;
}

topomap::Trajectory TrajectoryAssembly::newest() const {
  topomap::Trajectory out;
  out.version = version_;
  out.numbered_since = numbered_since_;
  for (const auto& [number, segment] : segments_) {
    if (std::uint64_t{number} * msg::kSegmentStops != out.stops.size()) break;
    out.stops.insert(out.stops.end(), segment.stops.begin(), segment.stops.end());
  }
  return out;
}

bool TrajectoryAssembly::complete() const {
  std::uint32_t total_stops = 0;
  std::size_t stops = 0;
  for (const auto& [number, segment] : segments_) {
    if (std::uint64_t{number} * msg::kSegmentStops != stops) return false;
    stops += segment.stops.size();
    total_stops = std::max(total_stops, segment.total_stops);
  }
  return stops > 0 && stops == total_stops;
}

const topomap::StopPose* TrajectoryAssembly::stop(std::size_t number) const {
  const auto held = segments_.find(static_cast<std::uint32_t>(number / msg::kSegmentStops));
  if (held == segments_.end()) return nullptr;
  const std::size_t index = number % msg::kSegmentStops;
  return index < held->second.stops.size() ? &held->second.stops[index] : nullptr;
}

std::optional<topomap::Trajectory> TrajectoryAssembly::whole(std::uint64_t version) const {
  topomap::Trajectory out;
  out.version = version;
  out.numbered_since = numbered_since_;
  std::uint32_t total_stops = 0;
  for (const auto& [number, segment] : segments_) {
    if (segment.version != version) return std::nullopt;
    if (std::uint64_t{number} * msg::kSegmentStops != out.stops.size()) return std::nullopt;
    out.stops.insert(out.stops.end(), segment.stops.begin(), segment.stops.end());
    total_stops = segment.total_stops;
  }
  if (segments_.empty() || out.stops.size() != total_stops) return std::nullopt;
  return out;
}

}  // namespace topogeo::service
