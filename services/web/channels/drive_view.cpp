#include "channels/drive_view.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/service/conversions.hpp"
#include "topogeo/service/map_replacement.hpp"
#include "topogeo/support/format.hpp"

#include "channels/event_log.hpp"
#include "channels/local_map_json.hpp"
#include "channels/protocol_names.hpp"
#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

/// After a closed loop all segments arrive at once and are shown together.
constexpr std::chrono::milliseconds kTrailPeriod{200};
constexpr std::size_t kChunk = 32;  // stops per key

Json decision_json(const msg::LoopDecision& decision) {
  Json json = {{"step", decision.step()},
               {"earlier", decision.earlier_id()},
               {"later", decision.later_id()},
               {"accepted", decision.outcome() == msg::kLoopAccepted},
               {"outcome", name_of(decision.outcome())},
               {"explanation", text_of_message(decision.explanation())},
               {"source", name_of(decision.source())}};
  set_pose(json, service::from_msg(decision.T_earlier_later()));
  Json predicted;
  set_pose(predicted, service::from_msg(decision.T_predicted()));
  predicted["covariance"] = Json::array();
  for (const double value : decision.predicted_covariance()) {
    predicted["covariance"].push_back(exact(value));
  }
  json["predicted"] = std::move(predicted);
  json["correction_m"] = rounded(decision.correction_m());
  json["correction_rad"] = rounded(decision.correction_rad());
  json["fitness"] = rounded(decision.fitness());
  json["probability"] = rounded(decision.probability());
  return json;
}

/// One event for all loops that arrive together, as those of a long drive do for a new service.
std::string loops_text(const std::vector<const msg::LoopDecision*>& closed) {
  const msg::LoopDecision& first = *closed.front();
  if (closed.size() == 1) {
    return fmt::format("closed a loop between stops {} and {}: the place moves by {:.2f} m",
                       first.earlier_id(), first.later_id(), first.correction_m());
  }
  std::uint32_t from = first.earlier_id();
  std::uint32_t to = first.later_id();
  double farthest_m = 0.0;
  for (const msg::LoopDecision* decision : closed) {
    from = std::min(from, decision->earlier_id());
    to = std::max(to, decision->later_id());
    farthest_m = std::max(farthest_m, decision->correction_m());
  }
  return fmt::format("closed {} loops between stops {} and {}: places move by up to {:.2f} m",
                     closed.size(), from, to, farthest_m);
}

const char* outcome_name(storage::LoopVerdict::Outcome outcome) {
  constexpr std::array<const char*, storage::LoopVerdict::kOutcomes> kNames = {
      "accepted", "gate", "unconfirmed", "no_closing", "outvoted"};
  return kNames.at(static_cast<std::size_t>(outcome));
}

Json verdict_json(const storage::LoopVerdict& verdict) {
  Json json = {{"step", verdict.step},
               {"earlier", verdict.earlier_id},
               {"later", verdict.later_id},
               {"accepted", verdict.outcome == storage::LoopVerdict::Outcome::kAccepted},
               {"outcome", outcome_name(verdict.outcome)},
               {"explanation", verdict.explanation},
               {"source", verdict.source}};
  set_pose(json, verdict.T_earlier_later);
  Json predicted;
  set_pose(predicted, verdict.T_predicted);
  predicted["covariance"] = Json::array();
  for (int i = 0; i < verdict.predicted_covariance.size(); ++i) {
    predicted["covariance"].push_back(exact(verdict.predicted_covariance(i / 3, i % 3)));
  }
  json["predicted"] = std::move(predicted);
  json["correction_m"] = rounded(verdict.correction_m);
  json["correction_rad"] = rounded(verdict.correction_rad);
  json["fitness"] = rounded(verdict.fitness);
  json["probability"] = rounded(verdict.probability);
  return json;
}

/// A loop of a map that keeps no evidence.
Json closure_json(const topomap::LoopClosure& loop) {
  Json json = {{"step", loop.later_id}, {"earlier", loop.earlier_id}, {"later", loop.later_id},
               {"accepted", true},      {"outcome", "accepted"},      {"explanation", ""},
               {"source", ""}};
  set_pose(json, loop.T_earlier_later);
  for (const char* unknown : {"correction_m", "correction_rad", "fitness", "probability"}) {
    json[unknown] = nullptr;
  }
  return json;
}

/// The loops of a stored map by step.
std::vector<Json> stored_loops(const storage::MapDocument& map) {
  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  std::set<Pair> explained;
  std::vector<std::pair<std::uint32_t, Json>> loops;
  for (const storage::LoopVerdict& verdict : map.loop_verdicts) {
    if (verdict.outcome == storage::LoopVerdict::Outcome::kAccepted) {
      explained.insert({verdict.earlier_id, verdict.later_id});
    }
    loops.emplace_back(verdict.step, verdict_json(verdict));
  }
  for (const topomap::LoopClosure& loop : map.loop_closures) {
    if (explained.contains({loop.earlier_id, loop.later_id})) continue;
    loops.emplace_back(loop.later_id, closure_json(loop));
  }
  std::ranges::stable_sort(loops, {}, [](const auto& entry) { return entry.first; });
  std::vector<Json> out;
  out.reserve(loops.size());
  for (auto& [step, json] : loops) out.push_back(std::move(json));
  return out;
}

}  // namespace

DriveView::DriveView(service::Service& service, ChannelHub& hub, EventLog& events)
    : hub_(hub), events_(events) {
  service.subscribe<msg::TrajectorySegment>(
      [this](const msg::TrajectorySegment& segment, const messaging::SampleInfo& info) {
        on_segment(segment, info);
      },
      {.of_map = true});
  service.subscribe<msg::LoopDecisions>(
      [this](const msg::LoopDecisions& decisions) { on_decisions(decisions); }, {.of_map = true});
  service.subscribe<msg::LocalMap>([this](const msg::LocalMap& map) { on_local_map(map); });
  service.subscribe<msg::MergeProposal>(
      [this](const msg::MergeProposal& proposal) { on_proposal(proposal); }, {.of_map = true});
  service::when_map_is_replaced(service, [this] {
    trajectory_ = {};
    heard_.clear();
    order_heard_.clear();
    loops_numbered_since_ = 0;
    loops_ = 0;
    hub_.edit(Channel::kLoops, {}, true);
  });
  service.loop().add_timer(kTrailPeriod, [this] {
    if (std::exchange(trail_changed_, false)) show_trail();
  });
}

void DriveView::on_segment(const msg::TrajectorySegment& message,
                           const messaging::SampleInfo& info) {
  // A localizer restarted in a finished map counts its stops from 0.
  if (info.writer != std::exchange(localizer_, info.writer)) trajectory_ = {};
  if (trajectory_.add(message)) trail_changed_ = true;
}

std::vector<geometry::Pose2> DriveView::T_map_stops() const {
  std::vector<geometry::Pose2> T_map_stops;
  T_map_stops.reserve(located_.size());
  for (const auto& [stop, T_map_stop] : located_) T_map_stops.push_back(T_map_stop);
  return T_map_stops;
}

void DriveView::show_trail() {
  show_stops(trajectory_.newest().stops);
  show_local_map();
}

void DriveView::show_stops(std::span<const topomap::StopPose> stops) {
  located_.clear();
  stops_.clear();
  std::vector<Edit> edits;
  Json chunk = Json::array();
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const topomap::StopPose& stop = stops[i];
    stops_.push_back(stop.stop);
    if (stop.located) {
      located_[stop.stop] = stop.T_map_robot;
      chunk.push_back(Json::array({rounded(stop.T_map_robot.x_m), rounded(stop.T_map_robot.y_m),
                                   rounded(stop.T_map_robot.theta_rad)}));
    } else {
      chunk.push_back(nullptr);
    }
    if (chunk.size() == kChunk || i + 1 == stops.size()) {
      edits.push_back({std::to_string(i / kChunk), text_of(chunk)});
      chunk = Json::array();
    }
  }
  hub_.edit(Channel::kTrail, std::move(edits), true);
}

void DriveView::show_stored(const storage::MapDocument& map) {
  if (trajectory_.version() != 0) return;
  show_stops(map.trajectory.stops);
  std::vector<Edit> edits;
  for (const Json& loop : stored_loops(map)) {
    edits.push_back({std::to_string(edits.size()), text_of(loop)});
  }
  hub_.edit(Channel::kLoops, std::move(edits), true);
}

std::optional<topomap::StopId> DriveView::stop_at(std::size_t number) const {
  if (number >= stops_.size()) return std::nullopt;
  return stops_[number];
}

std::optional<geometry::Pose2> DriveView::pose_of(const topomap::StopId& stop) const {
  const auto found = located_.find(stop);
  if (found == located_.end()) return std::nullopt;
  return found->second;
}

const topomap::LocalMap* DriveView::heard(const topomap::StopId& stop) const {
  const auto found = heard_.find(stop);
  return found == heard_.end() ? nullptr : &found->second;
}

void DriveView::on_decisions(const msg::LoopDecisions& message) {
  if (message.numbered_since() < loops_numbered_since_) return;
  if (message.numbered_since() > loops_numbered_since_) {
    loops_numbered_since_ = message.numbered_since();
    hub_.edit(Channel::kLoops, {}, true);
    loops_ = 0;
  }
  std::vector<Edit> edits;
  std::uint32_t number = message.segment() * msg::kSegmentDecisions;
  std::vector<const msg::LoopDecision*> closed;
  for (const msg::LoopDecision& decision : message.decisions()) {
    if (decision.outcome() == msg::kLoopAccepted && number >= loops_) closed.push_back(&decision);
    edits.push_back({std::to_string(number), text_of(decision_json(decision))});
    ++number;
  }
  if (!closed.empty()) events_.add(EventLog::Level::kInfo, "localizer", loops_text(closed));
  loops_ = std::max(loops_, number);
  hub_.edit(Channel::kLoops, std::move(edits));
}

void DriveView::on_local_map(const msg::LocalMap& message) {
  topomap::LocalMap map = service::from_msg(message);
  map.track.clear();
  const topomap::StopId stop = map.stop;
  if (heard_.insert_or_assign(stop, std::move(map)).second) {
    order_heard_.push_back(stop);
    if (order_heard_.size() > kMostHeard) {
      heard_.erase(order_heard_.front());
      order_heard_.pop_front();
    }
  }
  if (last_stop_ && last_stop_->session == stop.session && last_stop_->number > stop.number) return;
  last_stop_ = stop;
  show_local_map();
}

void DriveView::show_local_map() {
  const topomap::LocalMap* map = last_stop_ ? heard(*last_stop_) : nullptr;
  if (map == nullptr) return;
  hub_.set(Channel::kLocalMap, text_of(local_map_json(*map, pose_of(*last_stop_))));
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
  hub_.edit(Channel::kMerges, std::move(edits));
}

}  // namespace topogeo::web
