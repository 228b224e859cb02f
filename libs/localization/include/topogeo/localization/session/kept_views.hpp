// Which views of a map are kept when its places are seen again and again (docs/algorithms.md, "A
// map that is driven again").
//
// A map that every drive adds to would grow for ever, and what is gone would stay in it. Of each
// place the views of the last times are kept, so that the map follows what changes, and the oldest
// view that these do not contradict, so that it does not drift. Drives within an hour are one time:
// a door counts by how long it was open, not by how often the robot came by.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/localization/mapping/stored_map.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

/// How many times are kept of a place, besides the oldest view of it.
inline constexpr std::size_t kKeptTimes = 3;

/// A session that goes on for months counts as several drives, of so many stops each.
inline constexpr std::uint32_t kStopsOfDrive = 2000;

class KeptViews {
 public:
  /// Of the stops of a map; `maps[i]` is of `stops[i]`. The last `untouched` ones and the first
  /// one, the origin of the map, are kept. Drives alone in the map stay whole: a view is dropped
  /// only where another drive has the same.
  KeptViews(std::span<const topomap::LocalMap> maps, std::span<const topomap::StopPose> stops,
            std::size_t times = kKeptTimes, std::size_t untouched = 0,
            std::uint32_t stops_of_drive = kStopsOfDrive);

  /// Stops that are kept, ascending; their places here are their new ids.
  [[nodiscard]] const std::vector<std::uint32_t>& kept() const { return kept_; }
  [[nodiscard]] std::size_t dropped() const { return stops_.size() - kept_.size(); }
  [[nodiscard]] bool is_kept(std::uint32_t stop) const { return stops_[stop].by == stop; }
  /// The kept stop that sees what this one saw, by its id before; itself when it is kept.
  [[nodiscard]] std::uint32_t stands_for(std::uint32_t stop) const { return stops_[stop].by; }
  /// The new id of that.
  [[nodiscard]] std::uint32_t new_id(std::uint32_t stop) const { return new_ids_[stops_[stop].by]; }
  /// What a dropped stop saw is not there any more.
  [[nodiscard]] bool outdated(std::uint32_t stop) const { return stops_[stop].outdated; }

 private:
  struct Stop {
    std::uint32_t by = 0;
    bool outdated = false;
  };
  std::vector<Stop> stops_;
  std::vector<std::uint32_t> kept_;
  std::vector<std::uint32_t> new_ids_;  // of the kept ones, by their ids before
};

/// The trajectory of the kept stops in a new version. Views that show what a dropped one showed
/// stand for it.
topomap::Trajectory kept_trajectory(const topomap::Trajectory& trajectory, const KeptViews& kept);

/// The measurements between kept stops, and for those of dropped ones loops of the views that stand
/// for them, as far as these have few.
std::vector<PoseGraphEdge> kept_edges(std::span<const PoseGraphEdge> edges,
                                      std::span<const topomap::LocalMap> maps,
                                      std::span<const topomap::StopPose> stops,
                                      const KeptViews& kept);

/// The local maps of the kept stops with their new ids. One whose predecessor is not kept starts a
/// drive.
std::vector<topomap::LocalMap> kept_maps(std::span<const topomap::LocalMap> maps,
                                         const KeptViews& kept);

/// All of it.
StoredMap with_kept_views(const StoredMap& map, const KeptViews& kept);

}  // namespace topogeo::localization
