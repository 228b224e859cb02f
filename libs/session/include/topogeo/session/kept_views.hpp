// Selection of the views of a map to keep when its places are seen again and again
// (docs/algorithms.md, "A map that is driven again").
//
// A map that every drive extends would grow for ever and keep objects that are gone. Each place
// keeps the views of its last times, so that the map follows changes, and the oldest view that
// these do not contradict, so that it does not drift. Drives within an hour are one time: a door
// counts by how long it was open, not by how often the robot came by.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/slam/stored_map.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

/// Number of times kept per place, besides its oldest view.
inline constexpr std::size_t kKeptTimes = 3;

/// A session that goes on for months counts as several drives of this many stops each.
inline constexpr std::uint32_t kStopsOfDrive = 2000;

class KeptViews {
 public:
  /// Selects among the stops of a map; `maps[i]` belongs to `stops[i]`. The last `untouched` stops
  /// and the first one, the origin of the map, are kept. A map of a single drive is kept whole: a
  /// view is dropped only if another drive has the same.
  KeptViews(std::span<const topomap::LocalMap> maps, std::span<const topomap::StopPose> stops,
            std::size_t times = kKeptTimes, std::size_t untouched = 0,
            std::uint32_t stops_of_drive = kStopsOfDrive);

  /// Kept stops, ascending; their indices here are their new ids.
  [[nodiscard]] const std::vector<std::uint32_t>& kept() const { return kept_; }
  [[nodiscard]] std::size_t dropped() const { return stops_.size() - kept_.size(); }
  [[nodiscard]] bool is_kept(std::uint32_t stop) const { return stops_[stop].by == stop; }
  /// The kept stop whose view replaces that of this stop, by its old id; a kept stop itself.
  [[nodiscard]] std::uint32_t stands_for(std::uint32_t stop) const { return stops_[stop].by; }
  /// The new id of stands_for(stop).
  [[nodiscard]] std::uint32_t new_id(std::uint32_t stop) const { return new_ids_[stops_[stop].by]; }
  /// The objects that a dropped stop saw are no longer there.
  [[nodiscard]] bool outdated(std::uint32_t stop) const { return stops_[stop].outdated; }

 private:
  struct Stop {
    std::uint32_t by = 0;
    bool outdated = false;
  };
  std::vector<Stop> stops_;
  std::vector<std::uint32_t> kept_;
  std::vector<std::uint32_t> new_ids_;  // index: old id of a kept stop
};

/// The trajectory of the kept stops in a new version. A kept view inherits the counts of the
/// dropped views that it replaces.
topomap::Trajectory kept_trajectory(const topomap::Trajectory& trajectory, const KeptViews& kept);

/// The measurements between kept stops. Measurements of dropped stops become loops of the views
/// that replace them, where these have few.
std::vector<PoseGraphEdge> kept_edges(std::span<const PoseGraphEdge> edges,
                                      std::span<const topomap::LocalMap> maps,
                                      std::span<const topomap::StopPose> stops,
                                      const KeptViews& kept);

/// The local maps of the kept stops with their new ids. A map whose predecessor is not kept starts
/// a drive.
std::vector<topomap::LocalMap> kept_maps(std::span<const topomap::LocalMap> maps,
                                         const KeptViews& kept);

/// The whole map with only the kept stops.
StoredMap with_kept_views(const StoredMap& map, const KeptViews& kept);

}  // namespace topogeo::localization
