#include "drive_view.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/service/conversions.hpp"
#include "topogeo/support/format.hpp"

#include "event_log.hpp"
#include "json_values.hpp"
#include "protocol_names.hpp"

namespace topogeo::web {
namespace {

/// After a closed loop all segments come at once: they are shown together.
constexpr std::chrono::milliseconds kTrailPeriod{200};
constexpr std::size_t kChunk = 32;  // stops of a key

Json decision_json(const msg::LoopDecision& decision) {
  Json json = {{"step", decision.step()},
               {"earlier", decision.earlier_id()},
               {"later", decision.later_id()},
               {"accepted", decision.outcome() == msg::kLoopAccepted},
               {"outcome", name_of(decision.outcome())},
               {"explanation", text_of_message(decision.explanation())},
               {"source", name_of(decision.source())}};
  set_pose(json, service::from_msg(decision.T_earlier_later()));
  json["correction_m"] = rounded(decision.correction_m());
  json["correction_rad"] = rounded(decision.correction_rad());
  json["fitness"] = rounded(decision.fitness());
  json["probability"] = rounded(decision.probability());
  return json;
}

std::string local_map_json(const msg::LocalMap& map,
                           const std::optional<geometry::Pose2>& T_map_stop) {
  Json nodes = Json::array();
  for (const msg::LocalNode& node : map.nodes()) {
    if (!node.in_main_graph()) continue;
    nodes.push_back(Json::array({rounded(node.x_m()), rounded(node.y_m()), name_of(node.kind())}));
  }
  Json branches = Json::array();
  for (const msg::LocalBranch& branch : map.branches()) {
    if (!branch.in_main_graph()) continue;
    Json points = Json::array();
    for (const msg::BranchPoint& point : branch.points()) {
      points.push_back(rounded(point.x_m()));
      points.push_back(rounded(point.y_m()));
    }
    branches.push_back(std::move(points));
  }
  Json points = Json::array();
  for (const msg::ScanPoint& point : map.points()) {
    points.push_back(rounded(point.x_m()));
    points.push_back(rounded(point.y_m()));
  }
  Json json = {{"session", std::to_string(map.session())}, {"number", map.id()}};
  if (T_map_stop) set_pose(json, *T_map_stop);
  json["nodes"] = std::move(nodes);
  json["branches"] = std::move(branches);
  json["points_m"] = std::move(points);
  return text_of(json);
}

}  // namespace

DriveView::DriveView(service::Service& service, Board& board, EventLog& events)
    : board_(board), events_(events) {
  service.subscribe<msg::TrajectorySegment>(
      [this](const msg::TrajectorySegment& segment) { on_segment(segment); }, {.of_map = true});
  service.subscribe<msg::LoopDecisions>(
      [this](const msg::LoopDecisions& decisions) { on_decisions(decisions); }, {.of_map = true});
  service.subscribe<msg::LocalMap>([this](const msg::LocalMap& map) { on_local_map(map); });
  service.subscribe<msg::MergeProposal>(
      [this](const msg::MergeProposal& proposal) { on_proposal(proposal); }, {.of_map = true});
  service.loop().add_timer(kTrailPeriod, [this] {
    if (std::exchange(trail_changed_, false)) show_trail();
  });
}

void DriveView::on_segment(const msg::TrajectorySegment& message) {
  if (trajectory_.add(message)) trail_changed_ = true;
}

std::vector<geometry::Pose2> DriveView::T_map_stops() const {
  std::vector<geometry::Pose2> T_map_stops;
  T_map_stops.reserve(located_.size());
  for (const auto& [stop, T_map_stop] : located_) T_map_stops.push_back(T_map_stop);
  return T_map_stops;
}

void DriveView::show_trail() {
  const topomap::Trajectory trajectory = trajectory_.newest();
  located_.clear();
  std::vector<Edit> edits;
  Json chunk = Json::array();
  for (std::size_t i = 0; i < trajectory.stops.size(); ++i) {
    const topomap::StopPose& stop = trajectory.stops[i];
    if (stop.located) {
      located_[stop.stop] = stop.T_map_robot;
      chunk.push_back(Json::array({rounded(stop.T_map_robot.x_m), rounded(stop.T_map_robot.y_m),
                                   rounded(stop.T_map_robot.theta_rad)}));
    } else {
      chunk.push_back(nullptr);
    }
    if (chunk.size() == kChunk || i + 1 == trajectory.stops.size()) {
      edits.push_back({std::to_string(i / kChunk), text_of(chunk)});
      chunk = Json::array();
    }
  }
  board_.edit(Channel::kTrail, std::move(edits), true);
  show_local_map();
}

void DriveView::on_decisions(const msg::LoopDecisions& message) {
  if (message.numbered_since() < loops_numbered_since_) return;
  if (message.numbered_since() > loops_numbered_since_) {
    loops_numbered_since_ = message.numbered_since();
    board_.edit(Channel::kLoops, {}, true);
    loops_ = 0;
  }
  std::vector<Edit> edits;
  std::uint32_t number = message.segment() * msg::kSegmentDecisions;
  for (const msg::LoopDecision& decision : message.decisions()) {
    if (decision.outcome() == msg::kLoopAccepted && number >= loops_) {
      events_.add(EventLog::Level::kInfo, "localizer",
                  fmt::format("closed a loop between stops {} and {}: the place moves by {:.2f} m",
                              decision.earlier_id(), decision.later_id(), decision.correction_m()));
    }
    edits.push_back({std::to_string(number), text_of(decision_json(decision))});
    ++number;
  }
  loops_ = std::max(loops_, number);
  board_.edit(Channel::kLoops, std::move(edits));
}

void DriveView::on_local_map(const msg::LocalMap& message) {
  if (local_map_ && local_map_->session() == message.session() && local_map_->id() > message.id()) {
    return;
  }
  local_map_ = message;
  show_local_map();
}

void DriveView::show_local_map() {
  if (!local_map_) return;
  const auto found = located_.find(topomap::StopId{local_map_->session(), local_map_->id()});
  std::optional<geometry::Pose2> T_map_stop;
  if (found != located_.end()) T_map_stop = found->second;
  board_.set(Channel::kLocalMap, local_map_json(*local_map_, T_map_stop));
}

void DriveView::on_proposal(const msg::MergeProposal& message) {
  if (message.state() == msg::kMergeOpen) {
    events_.add(
        EventLog::Level::kWarning, "localizer",
        fmt::format("proposal {}: {} seems to be where {} has been; accept or refuse it",
                    message.number(), message.robot().c_str(), message.other_robot().c_str()));
  }
  std::vector<Edit> edits = {{std::to_string(message.number()),
                              text_of(Json{{"state", name_of(message.state())},
                                           {"robot", text_of_message(message.robot())},
                                           {"other_robot", text_of_message(message.other_robot())},
                                           {"confidence", rounded(message.confidence())},
                                           {"stops", message.stops()},
                                           {"distance_m", rounded(message.distance_m())},
                                           {"matches", message.matches()},
                                           {"fitness", rounded(message.fitness())},
                                           {"contradicted", rounded(message.contradicted())}})}};
  board_.edit(Channel::kMerges, std::move(edits));
}

}  // namespace topogeo::web
