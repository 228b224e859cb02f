// The drive on the board: stops, loops, proposals to join maps, the local map of the last stop.
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

#include "server/board.hpp"

namespace topogeo::web {

class EventLog;

/// Lives in the loop of its service.
class DriveView {
 public:
  /// So many local maps that were heard are kept.
  static constexpr std::size_t kMostHeard = 512;

  DriveView(service::Service& service, Board& board, EventLog& events);

  /// Where the stops of the map are.
  [[nodiscard]] std::vector<geometry::Pose2> T_map_stops() const;
  /// Stops and loops of a map that is only shown; nothing where a trajectory is heard.
  void show_stored(const storage::MapDocument& map);

  /// The stop of this number in the trajectory.
  [[nodiscard]] std::optional<topomap::StopId> stop_at(std::size_t number) const;
  /// T_map_robot, if its place is known.
  [[nodiscard]] std::optional<geometry::Pose2> pose_of(const topomap::StopId& stop) const;
  /// Without its track; null when it was not heard, or is not kept any more.
  [[nodiscard]] const topomap::LocalMap* heard(const topomap::StopId& stop) const;
  /// 0 while none is heard.
  [[nodiscard]] std::uint64_t trajectory_version() const { return trajectory_.version(); }

 private:
  void on_segment(const msg::TrajectorySegment& message, const messaging::SampleInfo& info);
  void on_decisions(const msg::LoopDecisions& message);
  void on_local_map(const msg::LocalMap& message);
  void on_proposal(const msg::MergeProposal& message);
  void show_trail();
  void show_stops(std::span<const topomap::StopPose> stops);
  void show_local_map();

  Board& board_;
  EventLog& events_;
  messaging::Handle localizer_{};  // whose trajectory it is
  service::TrajectoryAssembly trajectory_;
  bool trail_changed_ = false;
  std::map<topomap::StopId, geometry::Pose2> located_;  // T_map_robot of the stops of the map
  std::uint64_t loops_numbered_since_ = 0;
  std::uint32_t loops_ = 0;             // shown
  std::vector<topomap::StopId> stops_;  // of the trajectory
  std::map<topomap::StopId, topomap::LocalMap> heard_;
  std::deque<topomap::StopId> order_heard_;
  std::optional<topomap::StopId> last_stop_;
};

}  // namespace topogeo::web
