// Assembles the measurements behind a trajectory from their segments, which may arrive in any
// order.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "topogeo/msg/trajectory.h"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::service {

/// Keeps the newest of each segment of one robot.
class EdgeAssembly {
 public:
  /// Ignores a segment older than the one held; equal versions replace it. Throws
  /// std::invalid_argument like from_msg.
  void add(const msg::MapEdges& message);

  /// All measurements, once every segment that the newest one counts is here.
  [[nodiscard]] std::optional<std::vector<storage::MapEdge>> newest() const;
  /// All measurements, if each segment has exactly this version.
  [[nodiscard]] std::optional<std::vector<storage::MapEdge>> whole(std::uint64_t version) const;

 private:
  struct Segment {
    std::uint64_t version = 0;
    std::vector<storage::MapEdge> edges;
  };
  std::map<std::uint32_t, Segment> segments_;
  std::uint64_t version_ = 0;  // of the newest segment ...
  std::uint32_t total_ = 0;    // ... and the total that it gives
};

}  // namespace topogeo::service
