#include <algorithm>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"

#include "convert.hpp"

namespace topogeo::service {

using detail::check;
using detail::check_bound;

std::uint32_t segment_count(std::size_t stops) {
  return static_cast<std::uint32_t>((stops + msg::kSegmentStops - 1) / msg::kSegmentStops);
}

msg::TrajectorySegment to_segment(const topomap::Trajectory& trajectory, std::uint32_t segment,
                                  std::string_view robot_id, std::uint64_t sequence_number) {
  const std::size_t begin = std::size_t{segment} * msg::kSegmentStops;
  check(begin < trajectory.stops.size(), "segment", "less than the number of segments");
  const std::size_t end =
      std::min(begin + std::size_t{msg::kSegmentStops}, trajectory.stops.size());
  msg::TrajectorySegment out;
  messaging::set_header(out, robot_id, trajectory.stops.back().stamp_ns, sequence_number);
  out.segment(segment);
  out.version(trajectory.version);
  out.total_stops(static_cast<std::uint32_t>(trajectory.stops.size()));
  out.numbered_since(trajectory.numbered_since);
  for (std::size_t i = begin; i < end; ++i) {
    const topomap::StopPose& stop = trajectory.stops[i];
    check(stop.local_map_id == i, "stops.local_map_id", "the index in the trajectory");
    msg::StopPose pose;
    pose.local_map_id(stop.local_map_id);
    pose.stop(to_msg(stop.stop));
    pose.located(stop.located);
    pose.stamp_ns(stop.stamp_ns);
    pose.T_map_robot(to_msg(stop.T_map_robot));
    pose.covariance(to_msg(stop.covariance));
    pose.views(stop.views);
    pose.last_view_ns(stop.last_view_ns);
    out.stops().push_back(pose);
  }
  return out;
}

std::vector<msg::TrajectorySegment> to_segments(const topomap::Trajectory& trajectory,
                                                std::string_view robot_id,
                                                std::uint64_t first_sequence_number) {
  std::vector<msg::TrajectorySegment> out;
  for (std::uint32_t i = 0; i < segment_count(trajectory.stops.size()); ++i) {
    out.push_back(to_segment(trajectory, i, robot_id, first_sequence_number + i));
  }
  return out;
}

std::vector<topomap::StopPose> from_msg(const msg::TrajectorySegment& message) {
  detail::check_segment(message.segment());
  const std::uint64_t begin = std::uint64_t{message.segment()} * msg::kSegmentStops;
  check(message.total_stops() > begin, "total_stops", "more stops than before this segment");
  const std::uint64_t size =
      std::min<std::uint64_t>(msg::kSegmentStops, message.total_stops() - begin);
  check(message.stops().size() == size, "stops", "every stop of the segment");
  std::vector<topomap::StopPose> out;
  for (const msg::StopPose& pose : message.stops()) {
    check(pose.local_map_id() == begin + out.size(), "stops.local_map_id", "consecutive ids");
    check(pose.views() >= 1, "stops.views", "at least 1");
    out.push_back({pose.local_map_id(), pose.stamp_ns(), from_msg(pose.T_map_robot()),
                   from_msg(pose.covariance()), from_msg(pose.stop()), pose.located(), pose.views(),
                   pose.last_view_ns()});
  }
  return out;
}

msg::LoopClosures to_msg(std::span<const topomap::LoopClosure> closures,
                         std::uint64_t trajectory_version, std::string_view robot_id,
                         std::int64_t stamp_ns, std::uint64_t sequence_number,
                         std::uint64_t numbered_since) {
  check_bound("closures", closures.size(), msg::kMaxLoopClosures);
  msg::LoopClosures out;
  messaging::set_header(out, robot_id, stamp_ns, sequence_number);
  out.version(trajectory_version);
  out.numbered_since(numbered_since);
  for (const topomap::LoopClosure& closure : closures) {
    msg::LoopClosure entry;
    entry.earlier_id(closure.earlier_id);
    entry.later_id(closure.later_id);
    entry.T_earlier_later(to_msg(closure.T_earlier_later));
    out.closures().push_back(entry);
  }
  return out;
}

std::vector<topomap::LoopClosure> from_msg(const msg::LoopClosures& message) {
  std::vector<topomap::LoopClosure> out;
  for (const msg::LoopClosure& closure : message.closures()) {
    check(closure.earlier_id() < closure.later_id(), "closures.earlier_id", "less than later_id");
    out.push_back({closure.earlier_id(), closure.later_id(), from_msg(closure.T_earlier_later())});
  }
  return out;
}

std::uint32_t edge_segment_count(std::size_t edges) {
  const std::size_t segments = (edges + msg::kSegmentEdges - 1) / msg::kSegmentEdges;
  return static_cast<std::uint32_t>(std::max<std::size_t>(segments, 1));
}

msg::MapEdges to_segment(std::span<const storage::MapEdge> edges, std::uint32_t segment,
                         std::uint64_t trajectory_version, std::string_view robot_id,
                         std::int64_t stamp_ns, std::uint64_t sequence_number,
                         std::uint64_t numbered_since) {
  const std::size_t begin = std::size_t{segment} * msg::kSegmentEdges;
  check(segment < edge_segment_count(edges.size()), "segment", "less than the number of segments");
  msg::MapEdges out;
  messaging::set_header(out, robot_id, stamp_ns, sequence_number);
  out.segment(segment);
  out.version(trajectory_version);
  out.total(static_cast<std::uint32_t>(edges.size()));
  out.numbered_since(numbered_since);
  const std::size_t count = std::min<std::size_t>(msg::kSegmentEdges, edges.size() - begin);
  for (const storage::MapEdge& edge : edges.subspan(begin, count)) {
    msg::MapEdge entry;
    entry.earlier_id(edge.earlier_id);
    entry.later_id(edge.later_id);
    entry.kind(static_cast<msg::MapEdgeKind>(edge.kind));  // same values, see the IDL
    entry.T_earlier_later(to_msg(edge.T_earlier_later));
    entry.covariance(to_msg(edge.covariance));
    out.edges().push_back(entry);
  }
  return out;
}

std::vector<storage::MapEdge> from_msg(const msg::MapEdges& message) {
  detail::check_segment(message.segment());
  const std::uint64_t begin = std::uint64_t{message.segment()} * msg::kSegmentEdges;
  check(message.segment() < edge_segment_count(message.total()), "segment",
        "less than the number of segments");
  const std::uint64_t size = std::min<std::uint64_t>(msg::kSegmentEdges, message.total() - begin);
  check(message.edges().size() == size, "edges", "every edge of the segment");
  std::vector<storage::MapEdge> out;
  for (const msg::MapEdge& edge : message.edges()) {
    check(edge.earlier_id() < edge.later_id(), "edges.earlier_id", "less than later_id");
    check(edge.kind() <= msg::kEdgeLoop, "edges.kind", "a MapEdgeKind");
    out.push_back({edge.earlier_id(), edge.later_id(), from_msg(edge.T_earlier_later()),
                   from_msg(edge.covariance()), static_cast<storage::MapEdge::Kind>(edge.kind())});
  }
  return out;
}

msg::LivePose to_msg(const LivePose& pose, std::string_view robot_id) {
  msg::LivePose out;
  messaging::set_header(out, robot_id, pose.stamp_ns, pose.sequence);
  out.state(static_cast<msg::LocalizationState>(pose.status.state));  // same values, see the IDL
  out.confidence(pose.status.confidence);
  out.mode(pose.mode);
  out.T_map_robot(to_msg(pose.T_map_robot));
  out.covariance(to_msg(pose.covariance));
  out.last_stop(to_msg(pose.last_stop));
  out.trajectory_version(pose.trajectory_version);
  return out;
}

LivePose from_msg(const msg::LivePose& message) {
  check(message.state() <= msg::kStateLost, "state", "0 to 3");
  check(message.mode() <= msg::kModeMarkov, "mode", "0 to 2");
  check(message.confidence() >= 0.0 && message.confidence() <= 1.0, "confidence", "0 to 1");
  return {message.stamp_ns(),
          message.sequence_number(),
          {static_cast<localization::LocalizationState>(message.state()), message.confidence()},
          message.mode(),
          from_msg(message.T_map_robot()),
          from_msg(message.covariance()),
          from_msg(message.last_stop()),
          message.trajectory_version()};
}

}  // namespace topogeo::service
