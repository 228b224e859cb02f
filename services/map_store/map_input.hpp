// Collects the local maps, trajectory and loop closures of a robot, which may arrive in any order,
// also after a restart of the map store or of their senders.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/msg/stream.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/edge_assembly.hpp"
#include "topogeo/service/trajectory_assembly.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::map_store {

class MapInput {
 public:
  /// The map that is continued.
  struct Stored {
    std::vector<topomap::LocalMap> local_maps = {};  ///< of the map, with its numbers
    topomap::Trajectory trajectory = {};
    std::vector<topomap::LoopClosure> closures = {};
    std::vector<storage::MapEdge> edges = {};
    std::vector<storage::RefusedMerge> refused_merges = {};
    std::vector<topomap::LocalMap> waiting = {};             ///< as sent, in the order of arrival
    std::map<std::uint64_t, std::uint32_t> first_kept = {};  ///< see storage::SessionState
  };
  MapInput() = default;
  explicit MapInput(Stored stored);

  /// Largest number of maps waiting for the trajectory, about 60 MB; beyond it the oldest is
  /// dropped. Local maps wait in vain while the robot only localizes, and while a drive has not
  /// found its place in the map that it extends.
  static constexpr std::size_t kMostWaiting = 4096;

  enum class Arrival : std::uint8_t {
    kNew,
    kKnown,     ///< the same map came before, or too late to be used
    kDifferent  ///< another map came before with this id; that one stays
  };
  Arrival add(topomap::LocalMap map);

  /// Segments and closures older than those held are ignored. They throw std::invalid_argument like
  /// service::from_msg, and when they name other stops than the map has. A trajectory that
  /// renumbers its stops, because some have left the map, takes effect when it is complete.
  void add(const msg::TrajectorySegment& message);
  void add(const msg::LoopClosures& message);
  void add(const msg::MapEdges& message);
  void add(const storage::RefusedMerge& refused);
  /// The end of the localizer's stream; the last one counts.
  void set_end(const msg::StreamEnd& message) { end_ = message; }

  /// Local maps of the trajectory's stops, without gaps, with the trajectory's numbers.
  [[nodiscard]] const std::vector<topomap::LocalMap>& local_maps() const { return local_maps_; }
  /// Trajectory version since which the stops have these numbers.
  [[nodiscard]] std::uint64_t numbered_since() const { return trajectory_.numbered_since(); }
  /// Number of received maps that the trajectory does not have, or not yet.
  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }
  /// Number of dropped maps: the trajectory went on without them, or too many waited for it.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  /// A stop of the trajectory whose map was dropped: the local maps end before it.
  [[nodiscard]] std::optional<topomap::StopId> lost() const;
  /// The newest trajectory, up to the first stop whose map is missing.
  [[nodiscard]] topomap::Trajectory newest_trajectory() const;
  /// The newest closures between stops whose maps have arrived.
  [[nodiscard]] std::vector<topomap::LoopClosure> usable_closures() const;
  /// The newest measurements between stops whose maps have arrived.
  [[nodiscard]] std::vector<storage::MapEdge> usable_edges() const;
  /// Grows whenever usable_edges() may have changed: with each message, and with each local map.
  [[nodiscard]] std::uint64_t edge_changes() const { return edge_changes_; }
  /// Each refused merge once; none is ever removed.
  [[nodiscard]] const std::vector<storage::RefusedMerge>& refused_merges() const {
    return refused_merges_;
  }
  [[nodiscard]] std::uint64_t version() const { return trajectory_.version(); }

  /// The final trajectory, once everything that the end of the stream names has arrived: all maps,
  /// and all segments, closures and edges of the final version.
  [[nodiscard]] std::optional<topomap::Trajectory> final_trajectory() const;

 private:
  /// Distinguishes a map from another one with the same id.
  struct Arrived {
    std::uint64_t sequence = 0;
    std::uint64_t content_hash = 0;
    bool operator==(const Arrived&) const = default;
  };
  /// A trajectory with other stop numbers than the current map.
  struct Renewal {
    service::TrajectoryAssembly trajectory;
    std::vector<topomap::LoopClosure> closures;
    std::optional<std::uint64_t> closures_version;
    service::EdgeAssembly edges;
  };
  void check_stops(const msg::TrajectorySegment& message) const;
  Renewal& renewal_of(std::uint64_t numbered_since);
  /// Replaces the map by renewal_ once that is complete.
  void renew();
  void take_in(topomap::LocalMap map);
  void remember(const topomap::LocalMap& map);
  /// Adds the arrived maps that the trajectory names.
  void extend();
  /// Drops the maps that cannot be used any more.
  void drop_old();
  using Waiting = std::map<topomap::StopId, topomap::LocalMap>;
  void drop(Waiting::iterator map);
  [[nodiscard]] bool dropped(const topomap::StopId& stop) const;

  std::vector<topomap::LocalMap> local_maps_;
  std::map<topomap::StopId, Arrived> arrived_;
  Waiting waiting_;
  std::map<std::uint64_t, std::uint32_t> first_kept_;  // by session: numbers below are dropped
  std::vector<std::uint64_t> sessions_;                // in order of arrival
  std::uint64_t dropped_ = 0;
  service::TrajectoryAssembly trajectory_;
  std::vector<topomap::LoopClosure> closures_;
  std::optional<std::uint64_t> closures_version_;
  std::vector<storage::MapEdge> stored_edges_;  // until newer ones arrive
  service::EdgeAssembly edges_;
  std::uint64_t edge_changes_ = 0;
  std::vector<storage::RefusedMerge> refused_merges_;
  std::optional<Renewal> renewal_;
  std::uint64_t renewal_numbers_ = 0;  // numbered_since of renewal_
  std::optional<msg::StreamEnd> end_;
};

}  // namespace topogeo::map_store
