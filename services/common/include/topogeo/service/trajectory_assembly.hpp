// Assembles a trajectory from its segments, which may arrive in any order.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "topogeo/msg/trajectory.h"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::service {

/// Keeps the newest of each segment of one robot.
class TrajectoryAssembly {
 public:
  /// Returns false when the segment is older than the one held; equal versions replace it. When the
  /// stops have been renumbered since, the earlier segments are forgotten. Throws
  /// std::invalid_argument like from_msg.
  bool add(const msg::TrajectorySegment& message);

  /// Newest version of any segment; 0 without one.
  [[nodiscard]] std::uint64_t version() const { return version_; }

  /// See topomap::Trajectory.
  [[nodiscard]] std::uint64_t numbered_since() const { return numbered_since_; }
  /// Every stop has arrived, in whatever version.
  [[nodiscard]] bool complete() const;

  /// The newest pose of each stop up to the first missing segment. The segments may have different
  /// versions; `version` is the newest.
  [[nodiscard]] topomap::Trajectory newest() const;

  /// The newest pose of one stop; null until it has arrived.
  [[nodiscard]] const topomap::StopPose* stop(std::size_t number) const;

  /// The trajectory of exactly this version, if every segment of it is here.
  [[nodiscard]] std::optional<topomap::Trajectory> whole(std::uint64_t version) const;

 private:
  struct Segment {
    std::uint64_t version = 0;
    std::uint32_t total_stops = 0;
    std::vector<topomap::StopPose> stops;
  };
  std::map<std::uint32_t, Segment> segments_;
  std::uint64_t version_ = 0;
  std::uint64_t numbered_since_ = 0;
};

}  // namespace topogeo::service
