// The measurements that a trajectory is made of from the segments in which they travel, in whatever
// order they come.
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
  /// A segment older than the one that is held is passed over; equal versions replace. Throws
  /// std::invalid_argument like from_msg.
  void add(const msg::MapEdges& message);

  /// All of them, if every segment that the newest one counts is here.
  [[nodiscard]] std::optional<std::vector<storage::MapEdge>> newest() const;
  /// The same, if all of them are of exactly this version.
  [[nodiscard]] std::optional<std::vector<storage::MapEdge>> whole(std::uint64_t version) const;

 private:
  struct Segment {
    std::uint64_t version = 0;
    std::vector<storage::MapEdge> edges;
  };
  std::map<std::uint32_t, Segment> segments_;
  std::uint64_t version_ = 0;  // of the newest ...
  std::uint32_t total_ = 0;    // ... and what it counts
};

}  // namespace topogeo::service
