#include "trajectory_publisher.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/service/conversions.hpp"

namespace topogeo::localizer {

namespace {

bool same(const std::vector<topomap::LoopClosure>& a, const std::vector<topomap::LoopClosure>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    return x.earlier_id == y.earlier_id && x.later_id == y.later_id &&
           x.T_earlier_later == y.T_earlier_later;
  });
}

}  // namespace

TrajectoryPublisher::TrajectoryPublisher(service::Service& service)
    : service_(service),
      segment_writer_(service.advertise<msg::TrajectorySegment>()),
      closure_writer_(service.advertise<msg::LoopClosures>()),
      edge_writer_(service.advertise<msg::MapEdges>()),
      decision_writer_(service.advertise<msg::LoopDecisions>()) {}

bool TrajectoryPublisher::publish(const localization::Slam& slam,
                                  const topomap::Trajectory& trajectory, std::int64_t stamp_ns,
                                  bool whole) {
  version_ = trajectory.version;
  whole |= trajectory.numbered_since != numbered_since_;
  if (trajectory.numbered_since != numbered_since_) decisions_ = 0;
  numbered_since_ = trajectory.numbered_since;
  if (!send_segments(trajectory, whole)) return false;
  if (!send_edges(slam, trajectory.version, stamp_ns, whole)) return false;
  if (!send_decisions(slam.loop_decisions(), stamp_ns)) return false;
  std::vector<topomap::LoopClosure> closures = slam.loop_closures();
  if (!whole && same(closures, closures_)) return true;
  closures_ = std::move(closures);
  const msg::LoopClosures message =
      service::to_msg(closures_, trajectory.version, service_.robot_id(), stamp_ns,
                      closures_sent_++, numbered_since_);
  return service_.send(closure_writer_, message, "loop closures");
}

bool TrajectoryPublisher::send_segments(const topomap::Trajectory& trajectory, bool whole) {
  std::vector<std::uint32_t> numbers = updates_.update(trajectory);
  if (whole) {
    numbers.resize(service::segment_count(trajectory.stops.size()));
    for (std::uint32_t i = 0; i < numbers.size(); ++i) numbers[i] = i;
  }
  return std::all_of(numbers.begin(), numbers.end(), [&](std::uint32_t number) {
    const msg::TrajectorySegment segment =
        service::to_segment(trajectory, number, service_.robot_id(), segments_sent_++);
    return service_.send(segment_writer_, segment, "trajectory");
  });
}

// New edges are appended, so readers already have all edges before the first difference.
bool TrajectoryPublisher::send_edges(const localization::Slam& slam, std::uint64_t version,
                                     std::int64_t stamp_ns, bool whole) {
  std::vector<storage::MapEdge> edges = pipeline::map_edges(slam.edges());
  const auto differs = std::ranges::mismatch(edges, edges_).in1;
  if (!whole && differs == edges.end() && edges.size() == edges_.size()) return true;
  const auto first = whole ? std::size_t{0} : static_cast<std::size_t>(differs - edges.begin());
  edges_ = std::move(edges);
  const std::uint32_t count = service::edge_segment_count(edges_.size());
  // When edges were only removed, the last segment carries the new total.
  auto segment = std::min(static_cast<std::uint32_t>(first / msg::kSegmentEdges), count - 1);
  for (; segment < count; ++segment) {
    const msg::MapEdges message =
        service::to_segment(edges_, segment, version, service_.robot_id(), stamp_ns,
                            edge_segments_sent_++, numbered_since_);
    if (!service_.send(edge_writer_, message, "edges")) return false;
  }
  return true;
}

// Decisions are only appended, so only the last segment sent and those after it have changed.
bool TrajectoryPublisher::send_decisions(const std::vector<localization::LoopDecision>& decisions,
                                         std::int64_t stamp_ns) {
  if (decisions.size() == decisions_) return true;
  const auto first = static_cast<std::uint32_t>(decisions_ / msg::kSegmentDecisions);
  for (std::uint32_t i = first; i < service::decision_segment_count(decisions.size()); ++i) {
    const msg::LoopDecisions segment = service::to_segment(
        decisions, i, service_.robot_id(), stamp_ns, decision_segments_sent_++, numbered_since_);
    if (!service_.send(decision_writer_, segment, "loop decisions")) return false;
  }
  decisions_ = decisions.size();
  return true;
}

}  // namespace topogeo::localizer
