// The drive on the board: stops, loops, proposals to join maps, the local map of the last stop.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "topogeo/msg/local_map.h"
#include "topogeo/msg/merge.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/service.hpp"
#include "topogeo/service/trajectory_assembly.hpp"
#include "topogeo/topomap/trajectory.hpp"

#include "board.hpp"

namespace topogeo::web {

class EventLog;

/// Lives in the loop of its service.
class DriveView {
 public:
  DriveView(service::Service& service, Board& board, EventLog& events);

  /// Where the stops of the map are.
  [[nodiscard]] std::vector<geometry::Pose2> T_map_stops() const;

 private:
  void on_segment(const msg::TrajectorySegment& message);
  void on_decisions(const msg::LoopDecisions& message);
  void on_local_map(const msg::LocalMap& message);
  void on_proposal(const msg::MergeProposal& message);
  void show_trail();
  void show_local_map();

  Board& board_;
  EventLog& events_;
  service::TrajectoryAssembly trajectory_;
  bool trail_changed_ = false;
  std::map<topomap::StopId, geometry::Pose2> located_;  // T_map_robot of the stops of the map
  std::uint64_t loops_numbered_since_ = 0;
  std::uint32_t loops_ = 0;                 // shown
  std::optional<msg::LocalMap> local_map_;  // of the last stop
};

}  // namespace topogeo::web
