#include "topogeo/session/shared_map.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include "topogeo/session/kept_views.hpp"
#include "topogeo/slam/pose_graph_slam.hpp"
#include "topogeo/slam/stored_map.hpp"

#include "robot_parts.hpp"
#include "shared_pool.hpp"
#include "stop_numbers.hpp"

namespace topogeo::localization {

using geometry::Pose2;
using topomap::StopId;

namespace {

// Stops searched again in a map that has grown: enough to find a place.
constexpr std::size_t kLastStops = 12;
// All poses follow from all measurements. They are computed after this many new links and stops,
// not at every stop of a large map.
constexpr std::size_t kNewLinks = 6;
constexpr std::size_t kStopsBetween = 4;
constexpr std::size_t kShareOfStops = 50;

}  // namespace

struct SharedMap::Own {
  SharedPool pool;
  RobotParts parts{};
  StopNumbers numbers{};
};

SharedMap::~SharedMap() = default;

SharedMap::SharedMap(const LocalizerConfig& config, MatchPool& pool,
                     const std::shared_ptr<const StoredMap>& stored, std::size_t most_apart)
    : config_(config),
      most_apart_(most_apart),
      own_(new Own{SharedPool(pool)}),
      pool_(own_->pool),
      parts_(own_->parts),
      numbers_(own_->numbers) {
  if (config.mode != SlamAlgorithm::kGraph) {
    throw std::invalid_argument("localizer.mode: several robots map in mode graph only");
  }
  if (!stored) return;
  check(*stored);
  version_ = stored->trajectory.version;
  numbers_ = StopNumbers(stored->trajectory.numbered_since);
  parts_.add(MapPart(parts_.next(), stored), "");
  number_stops(true);
}

// --- stops

bool SharedMap::add(MapPointer map) {
  RobotPart& part = part_for(*map);
  part.map.add(map);
  ++version_;
  last_robot_ = map->robot_id;
  follow_on(part, *map);
  const bool moved = part.map.take_moved();
  Due& due = due_[part.group];
  ++due.stops;
  due.moved |= moved;
  if (part.map.find(map->stop)) {
    meet(part, map);
  } else {
    part.meetings.clear();  // no pose in its own map
  }
  part.last.push_back(map);
  if (part.last.size() > kLastStops) part.last.erase(part.last.begin());
  place_if_due(part.group);
  proposals_.check(finder());
  number_stops(false);
  return moved;
}

RobotPart& SharedMap::part_for(const topomap::LocalMap& map) {
  RobotPart* const part = parts_.live(map.robot_id);
  if (part != nullptr) {
    const bool too_long =
        part->group != parts_.root() && stops_of(parts_.group(part->group)) >= most_apart_;
    if (!too_long && part->last.back()->stop.session == map.stop.session) return *part;
    parts_.end(*part);
  }
  return parts_.add(MapPart(parts_.next(), config_, pool_.view()), map.robot_id);
}

// A session whose last stop is in the stored map continues from there.
void SharedMap::follow_on(RobotPart& part, const topomap::LocalMap& map) {
  if (part.map.size() != 1 || map.stop.number == 0 || !part.last.empty()) return;
  const StopId before{map.stop.session, map.stop.number - 1};
  const RobotPart* const held = parts_.part_of(before);
  if (held == nullptr) return;
  const topomap::LocalMap& last = *held->map.maps()[*held->map.find(before)];
  const UncertainPose step = odometry_between_stops(last.T_odom_robot, map, config_.odometry);
  part.map.place({compose(*parts_.pose_of(before), step)});
  part.group = held->group;
  parts_.link({before, map.stop, EdgeKind::kOdometry, step});
}

MergeProposals::Find SharedMap::finder() const {
  return [this](const StopId& stop) -> std::optional<MergeProposals::Placed> {
    const RobotPart* const part = parts_.part_of(stop);
    if (part == nullptr) return std::nullopt;
    return MergeProposals::Placed{part->group, parts_.pose_of(stop)->T_a_b};
  };
}

// --- robots in each other's maps

void SharedMap::meet(RobotPart& part, const MapPointer& map) {
  for (const std::uint32_t number : parts_.groups()) {
    const std::vector<MapPart*> others = parts_.group(number, &part);
    if (stops_of(others) == 0) continue;
    Meeting& meeting = part.meetings.try_emplace(number, config_, pool_.view()).first->second;
    const bool is_own = number == part.group;
    if (meeting.wants_map(stops_of(others))) {
      meeting.set_map(std::make_shared<const StoredMap>(map_of(whole_parts(others))),
                      is_own ? std::span<const MapPointer>() : part.last);
    }
    if (is_own) {
      meet_own(meeting, map);
    } else if (meeting.add(map)) {
      propose(part, meeting);
      if (!parts_.groups().contains(number) || part.group == number) return;  // joined
    }
  }
}

// Within one map the robot's pose is known, so it is never searched.
void SharedMap::meet_own(Meeting& meeting, const MapPointer& map) {
  if (map->stop.number == 0) return;
  const StopId before{map->stop.session, map->stop.number - 1};
  const RobotPart* const held = parts_.part_of(before);
  if (held == nullptr) return;
  meeting.expect(held->map.maps()[*held->map.find(before)], *parts_.pose_of(before));
  meeting.add(map);
  add_links(meeting.newest(), held->group);
}

void SharedMap::propose(const RobotPart& part, const Meeting& meeting) {
  MergeProposal found;
  found.robot = part.robot;
  found.place = meeting.newest().front();
  const RobotPart* const other = parts_.part_of(found.place.other);
  found.other_robot = other->map.maps()[*other->map.find(found.place.other)]->robot_id;
  found.T_other_own = parts_.pose_of(found.place.other)->T_a_b * found.place.T_other_stop.T_a_b *
                      geometry::inverse(parts_.pose_of(found.place.stop)->T_a_b);
  found.confidence = meeting.confidence();
  found.stops = meeting.confirmation().stops();
  found.distance_m = meeting.confirmation().distance_m();
  found.contradicted = meeting.confirmation().contradicted();
  found.matches = static_cast<std::uint32_t>(meeting.sightings().size());
  for (const Sighting& sighting : meeting.sightings()) found.fitness += sighting.fitness;
  found.fitness /= static_cast<double>(found.matches);
  if (!proposals_.offer(std::move(found), finder())) return;
  if (config_.merge == MergePolicy::kAsk) return;
  const auto open =
      std::ranges::find(proposals_.all(), MergeProposal::State::kOpen, &MergeProposal::state);
  join(proposals_.accept(open->number));
}

void SharedMap::accept(std::uint32_t number) {
  join(proposals_.accept(number));
  proposals_.check(finder());
  ++version_;
  number_stops(false);
}

void SharedMap::refuse(std::uint32_t number) {
  const MergeProposal proposal = proposals_.refuse(number);
  const std::uint32_t a = parts_.part_of(proposal.place.stop)->group;
  const std::uint32_t b = parts_.part_of(proposal.place.other)->group;
  for (const std::unique_ptr<RobotPart>& part : parts_.all()) {
    if (part->group != a && part->group != b) continue;
    const auto meeting = part->meetings.find(part->group == a ? b : a);
    if (meeting != part->meetings.end()) meeting->second.forget();
  }
}

// The older map keeps its frame.
void SharedMap::join(const MergeProposal& proposal) {
  std::uint32_t moved = parts_.part_of(proposal.place.stop)->group;
  std::uint32_t kept = parts_.part_of(proposal.place.other)->group;
  Pose2 T_kept_moved = parts_.pose_of(proposal.place.other)->T_a_b *
                       proposal.place.T_other_stop.T_a_b *
                       geometry::inverse(parts_.pose_of(proposal.place.stop)->T_a_b);
  const auto first = std::ranges::find_if(
      parts_.all(), [&](const auto& part) { return part->group == moved || part->group == kept; });
  if ((*first)->group == moved) {
    std::swap(moved, kept);
    T_kept_moved = geometry::inverse(T_kept_moved);
  }
  parts_.link(proposal.place);
  const std::vector<RobotPart*> joining = parts_.unite(kept, moved, T_kept_moved);
  due_.erase(moved);
  place(kept);
  for (RobotPart* part : joining) compare_again(*part);
  place(kept);
  if (kept == parts_.root()) prune();
}

// Reduces the ended drives of the map to the views that no other shows (KeptViews), as when one
// robot drives again. They become one part.
void SharedMap::prune() {
  const std::vector<MapPart*> over = parts_.over(parts_.root());
  const PartOrder order = whole_parts(over);
  StoredMap before = map_of(order);
  before.edges = edges_between(order, parts_.links());
  const KeptViews kept(before.maps, before.trajectory.stops);
  if (kept.dropped() == 0) return;
  parts_.replace_over(parts_.root(), before, kept);
}

// Matches the stops of a part with the views of all others in its map. Replaces earlier matches,
// which were made in smaller maps with other poses.
void SharedMap::compare_again(RobotPart& part) {
  std::vector<MapPart*> others;
  for (RobotPart* other : parts_.by_first_stop(part.group)) {
    if (other != &part) others.push_back(&other->map);
  }
  if (stops_of(others) == 0) return;
  Meeting meeting(config_, pool_.view());
  meeting.set_map(std::make_shared<const StoredMap>(map_of(whole_parts(others))), {});
  const std::vector<MapPointer>& maps = part.map.maps();
  const std::size_t most = MappingSession::kMostWaiting;
  for (std::size_t i = maps.size() > most ? maps.size() - most : 0; i < maps.size(); ++i) {
    if (i > 0) meeting.expect(maps[i - 1], part.map.poses()[i - 1]);
    meeting.add(maps[i]);
    parts_.unlink(maps[i]->stop);
    add_links(meeting.newest(), part.group);
  }
  parts_.count(meeting.counts());
}

// Treats each part as the last drive of the joint map and adds the loops that no part saw alone.
// Each part takes a turn, because a stop that looks along a corridor finds one ahead, but that one
// hardly finds it.
void SharedMap::close_loops(std::uint32_t group) {
  const std::vector<RobotPart*> parts = parts_.by_first_stop(group);
  for (const RobotPart* last : parts) {
    std::vector<MapPart*> drives;
    drives.reserve(parts.size());
    for (RobotPart* part : parts) drives.push_back(&part->map);
    std::stable_partition(drives.begin(), drives.end(),
                          [&](const MapPart* map) { return map != &last->map; });
    const PartOrder order = whole_parts(drives);
    auto map = std::make_shared<StoredMap>(map_of(order));
    map->edges = edges_between(order, parts_.links());
    const std::unique_ptr<MatchPool> pool = pool_.view();
    PoseGraphSlam all(config_, *pool, nullptr, map);
    all.compare_stored(static_cast<std::uint32_t>(map->maps.size() - last->map.size()));
    parts_.count(all.counts());
    for (const PoseGraphEdge& edge : all.edges()) {
      if (contains_like(map->edges, edge)) continue;
      parts_.link({map->maps[edge.from].stop, map->maps[edge.to].stop, edge.kind,
                   UncertainPose{edge.T_from_to, edge.covariance}});
    }
    place(group);
  }
}

void SharedMap::add_links(std::span<const Sighting> sightings, std::uint32_t group) {
  for (const Sighting& sighting : sightings) {
    if (parts_.link(sighting)) ++due_[group].links;
  }
}

// --- the map of all

void SharedMap::place(std::uint32_t group) {
  const std::vector<MapPart*> parts = parts_.group(group);
  due_[group] = {};
  if (parts.size() > 1) {
    place_jointly(parts, parts_.links());
    parts_.drop_outvoted_links();
    ++placed_;
  } else if (parts.front()->goes_on()) {
    parts.front()->place_as_own();
  }
}

void SharedMap::place_if_due(std::uint32_t group) {
  const std::vector<MapPart*> parts = parts_.group(group);
  const Due& due = due_[group];
  const std::size_t wait = std::max(kStopsBetween, stops_of(parts) / kShareOfStops);
  const bool is_worth_it = due.moved || due.links >= kNewLinks;
  if (parts.size() == 1 || (is_worth_it && due.stops >= wait)) place(group);
}

// Repeats all matches between robots, each part with the others, in an order independent of the
// arrival.
void SharedMap::finish() {
  if (parts_.empty()) return;
  for (const std::unique_ptr<RobotPart>& part : parts_.all()) part->map.finish();
  for (const std::uint32_t number : parts_.groups()) {
    place(number);
    for (RobotPart* part : parts_.by_first_stop(number)) compare_again(*part);
    place(number);
    if (parts_.group(number).size() > 1) close_loops(number);
  }
  ++version_;
  number_stops(true);
}

void SharedMap::number_stops(bool all) {
  if (parts_.empty()) return;
  numbers_.update(whole_parts(parts_.group(parts_.root())), all, version_);
  edges_ = edges_between(numbers_.order(), parts_.links());
}

topomap::Trajectory SharedMap::trajectory() const {
  topomap::Trajectory trajectory = trajectory_of(numbers_.order());
  trajectory.version = version_;
  trajectory.numbered_since = numbers_.numbered_since();
  return trajectory;
}

std::vector<topomap::LoopClosure> SharedMap::loop_closures() const {
  std::vector<topomap::LoopClosure> closures;
  for (const PoseGraphEdge& edge : edges_) {
    if (edge.kind == EdgeKind::kRevisit) closures.push_back({edge.from, edge.to, edge.T_from_to});
  }
  return closures;
}

const std::vector<LoopDecision>& SharedMap::loop_decisions() const {
  static const std::vector<LoopDecision> kNone;
  return kNone;
}

StoredMap SharedMap::map() const {
  StoredMap map = map_of(numbers_.order());
  map.trajectory = trajectory();
  map.loop_closures = loop_closures();
  map.edges = edges_;
  return map;
}

// --- robots

std::optional<topomap::StopPose> SharedMap::last_stop() const {
  return last_stop(last_robot_);
}

std::optional<topomap::StopPose> SharedMap::last_stop(const std::string& robot) const {
  const RobotPart* const part = parts_.live(robot);
  if (part == nullptr) return std::nullopt;
  const MapPart& map = part->map;
  std::optional<topomap::StopPose> stop = map.session()->last_stop();
  if (!stop) return stop;
  const std::uint32_t i = map.find(stop->stop).value_or(static_cast<std::uint32_t>(map.size() - 1));
  const Pose2 T_here_stop = geometry::between(map.own().stops[i].T_map_robot, stop->T_map_robot);
  stop->T_map_robot = map.poses()[i].T_a_b * T_here_stop;
  stop->covariance = map.poses()[i].covariance;
  stop->located &= joined(robot);
  return stop;
}

LocalizationStatus SharedMap::status(const std::string& robot) const {
  if (!joined(robot)) return {LocalizationState::kSearching, 0.0};
  return parts_.live(robot)->map.session()->status();
}

bool SharedMap::joined(const std::string& robot) const {
  const RobotPart* const part = parts_.live(robot);
  return part != nullptr && part->group == parts_.root();
}

std::size_t SharedMap::stops_apart() const {
  std::size_t stops = 0;
  for (const std::unique_ptr<RobotPart>& part : parts_.all()) {
    if (part->group != parts_.root()) stops += part->map.size();
  }
  return stops;
}

SlamCounts SharedMap::counts() const {
  SlamCounts counts = parts_.counts();
  counts.optimizations += placed_;
  return counts;
}

}  // namespace topogeo::localization
