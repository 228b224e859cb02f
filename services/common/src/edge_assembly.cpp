#include "topogeo/service/edge_assembly.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/service/conversions.hpp"

namespace topogeo::service {

void EdgeAssembly::add(const msg::MapEdges& message) {
  std::vector<storage::MapEdge> edges = from_msg(message);
  Segment& held = segments_[message.segment()];
  if (message.version() < held.version) return;
  held = {message.version(), std::move(edges)};
  if (message.version() < version_) return;
  version_ = message.version();
  total_ = message.total();
}

std::optional<std::vector<storage::MapEdge>> EdgeAssembly::newest() const {
  if (segments_.empty()) return std::nullopt;
  std::vector<storage::MapEdge> out;
  std::uint32_t next = 0;
  for (const auto& [number, segment] : segments_) {
    if (number >= edge_segment_count(total_)) break;  // edges were removed
    const std::size_t wanted = std::min<std::size_t>(
        msg::kSegmentEdges, total_ - std::size_t{number} * msg::kSegmentEdges);
    if (number != next++ || segment.edges.size() < wanted) return std::nullopt;
    out.insert(out.end(), segment.edges.begin(),
               segment.edges.begin() + static_cast<std::ptrdiff_t>(wanted));
  }
  if (out.size() != total_) return std::nullopt;
  return out;
}

std::optional<std::vector<storage::MapEdge>> EdgeAssembly::whole(std::uint64_t version) const {
  for (std::uint32_t i = 0; i < edge_segment_count(total_); ++i) {
    const auto held = segments_.find(i);
    if (held == segments_.end() || held->second.version != version) return std::nullopt;
  }
  return newest();
}

}  // namespace topogeo::service
