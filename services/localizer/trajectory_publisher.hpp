// Publishes trajectory, closed loops and loop decisions: the changes after each step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/service.hpp"
#include "topogeo/slam/loop/loop_decision.hpp"
#include "topogeo/slam/slam.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/topomap/trajectory.hpp"

#include "trajectory_updates.hpp"

namespace topogeo::localizer {

class TrajectoryPublisher {
 public:
  /// Throws like Writer.
  explicit TrajectoryPublisher(service::Service& service);

  /// Sends the changes since the last call, or (`whole`) everything, so that a reader has it all in
  /// one version. `stamp_ns` is the stamp of the last stop. Returns false when the service stops
  /// before everything is sent.
  [[nodiscard]] bool publish(const localization::Slam& slam, const topomap::Trajectory& trajectory,
                             std::int64_t stamp_ns, bool whole);

  /// Version of the trajectory published last.
  [[nodiscard]] std::uint64_t version() const { return version_; }
  /// Number of closed loops sent last.
  [[nodiscard]] std::size_t closures() const { return closures_.size(); }

 private:
  bool send_segments(const topomap::Trajectory& trajectory, bool whole);
  bool send_edges(const localization::Slam& slam, std::uint64_t version, std::int64_t stamp_ns,
                  bool whole);
  bool send_decisions(const std::vector<localization::LoopDecision>& decisions,
                      std::int64_t stamp_ns);

  service::Service& service_;
  messaging::Writer<msg::TrajectorySegment> segment_writer_;
  messaging::Writer<msg::LoopClosures> closure_writer_;
  messaging::Writer<msg::MapEdges> edge_writer_;
  messaging::Writer<msg::LoopDecisions> decision_writer_;
  TrajectoryUpdates updates_;
  std::uint64_t version_ = 0;
  std::uint64_t numbered_since_ = 0;
  std::vector<topomap::LoopClosure> closures_;
  std::vector<storage::MapEdge> edges_;  // as sent
  std::size_t decisions_ = 0;
  std::uint64_t segments_sent_ = 0;
  std::uint64_t closures_sent_ = 0;
  std::uint64_t edge_segments_sent_ = 0;
  std::uint64_t decision_segments_sent_ = 0;
};

}  // namespace topogeo::localizer
