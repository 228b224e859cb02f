// The global map while the robot drives, built in small steps: new local maps are added, and after
// a noticeable correction of earlier poses all are fused again. The stored map differs: it is fused
// in one go at the end, so that it does not depend on the order in which local maps came.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/global_map_builder.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::map_store {

class LiveMap {
 public:
  /// Smaller corrections of earlier poses wait for the next larger one.
  static constexpr double kMoved_m = 0.05;
  static constexpr double kTurned_rad = 0.0174532925;  // 1 degree

  explicit LiveMap(const topomap::GlobalMapConfig& config);

  /// Starts over if stops have been renumbered since.
  void renumber(std::uint64_t numbered_since);

  /// Starts over if a pose has moved since its map was fused, but not during a rebuild, which would
  /// then never end.
  void check(std::span<const topomap::StopPose> stops);

  /// Fuses the next of `maps` at the next pose of `stops`. False when all are fused. Throws
  /// std::invalid_argument when the map cannot be fused; it is then left out.
  bool step(std::span<const topomap::LocalMap> maps, std::span<const topomap::StopPose> stops);

  /// Maps fused so far.
  [[nodiscard]] std::size_t size() const { return used_.size(); }
  /// Rebuilds so far.
  [[nodiscard]] std::uint64_t rebuilds() const { return rebuilds_; }
  [[nodiscard]] topomap::GlobalMap snapshot(std::uint64_t version) const {
    return builder_.snapshot(version);
  }

 private:
  void start_anew();

  topomap::GlobalMapConfig config_;
  topomap::GlobalMapBuilder builder_;
  std::vector<geometry::Pose2> used_;  // pose at which each map was fused
  std::size_t rebuild_until_ = 0;      // size() at which the last rebuild is complete
  std::uint64_t rebuilds_ = 0;
  std::uint64_t numbered_since_ = 0;
};

}  // namespace topogeo::map_store
