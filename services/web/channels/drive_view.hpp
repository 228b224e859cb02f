// The drive on the hub: stops, loops, proposals to join maps, the last stop's local map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/msg/local_map.h"
#include "topogeo/msg/merge.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/service.hpp"
#include "topogeo/service/trajectory_assembly.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/topomap/trajectory.hpp"

#include "server/channel_hub.hpp"

namespace topogeo::web {

class EventLog;

/// Lives in the loop of its service.
class DriveView {
 public:
  /// Number of received local maps that are kept.
  static constexpr std::size_t kMostHeard = 512;

  DriveView(service::Service& service, ChannelHub& hub, EventLog& events);

  /// Poses of the stops on the map.
  [[nodiscard]] std::vector<geometry::Pose2> T_map_stops() const;
  /// Shows stops and loops of a finished map, unless a trajectory is received.
  void show_stored(const storage::MapDocument& map);

  /// The stop of this number in the trajectory.
  [[nodiscard]] std::optional<topomap::StopId> stop_at(std::size_t number) const;
  /// T_map_robot, if the pose is known.
  [[nodiscard]] std::optional<geometry::Pose2> pose_of(const topomap::StopId& stop) const;
  /// The received map without its track; null if it was not received or is no longer kept.
  [[nodiscard]] const topomap::LocalMap* heard(const topomap::StopId& stop) const;
  /// 0 until one is received.
  [[nodiscard]] std::uint64_t trajectory_version() const { return trajectory_.version(); }

 private:
  void on_segment(const msg::TrajectorySegment& message, const messaging::SampleInfo& info);
  void on_decisions(const msg::LoopDecisions& message);
  void on_local_map(const msg::LocalMap& message);
  void on_proposal(const msg::MergeProposal& message);
  void show_trail();
  void show_stops(std::span<const topomap::StopPose> stops);
  void show_local_map();

  ChannelHub& hub_;
  EventLog& events_;
  messaging::Handle localizer_{};  // writer of the trajectory
  service::TrajectoryAssembly trajectory_;
  bool trail_changed_ = false;
  std::map<topomap::StopId, geometry::Pose2> located_;  // T_map_robot of the map's stops
  std::uint64_t loops_numbered_since_ = 0;
  std::uint32_t loops_ = 0;             // shown
  std::vector<topomap::StopId> stops_;  // of the trajectory
  std::map<topomap::StopId, topomap::LocalMap> heard_;
  std::deque<topomap::StopId> order_heard_;
  std::optional<topomap::StopId> last_stop_;
};

}  // namespace topogeo::web
