#include "robot_parts.hpp"

#include <algorithm>

namespace topogeo::localization {

using topomap::StopId;

namespace {

// A right match exceeds this squared Mahalanobis distance once in a million (chi-square, three
// degrees of freedom), as for the loops of one robot.
constexpr double kLinkOutvoted = 30.0;

}  // namespace

std::size_t stops_of(std::span<MapPart* const> parts) {
  std::size_t stops = 0;
  for (const MapPart* part : parts) stops += part->size();
  return stops;
}

RobotPart& RobotParts::add(MapPart part, const std::string& robot) {
  parts_.push_back(std::make_unique<RobotPart>(RobotPart{std::move(part), robot, next_++}));
  return *parts_.back();
}

std::set<std::uint32_t> RobotParts::groups() const {
  std::set<std::uint32_t> out;
  for (const std::unique_ptr<RobotPart>& part : parts_) out.insert(part->group);
  return out;
}

std::vector<MapPart*> RobotParts::group(std::uint32_t number, const RobotPart* without) const {
  std::vector<MapPart*> out;
  for (const std::unique_ptr<RobotPart>& part : parts_) {
    if (part->group == number && part.get() != without) out.push_back(&part->map);
  }
  return out;
}

std::vector<RobotPart*> RobotParts::by_first_stop(std::uint32_t number) const {
  std::vector<RobotPart*> out;
  for (const std::unique_ptr<RobotPart>& part : parts_) {
    if (part->group == number && part->map.size() > 0) out.push_back(part.get());
  }
  std::ranges::sort(out, {}, [](const RobotPart* part) { return part->map.maps().front()->stop; });
  return out;
}

RobotPart* RobotParts::live(const std::string& robot) const {
  for (const std::unique_ptr<RobotPart>& part : parts_) {
    if (part->map.goes_on() && part->robot == robot) return part.get();
  }
  return nullptr;
}

RobotPart* RobotParts::part_of(const StopId& stop) const {
  for (const std::unique_ptr<RobotPart>& part : parts_) {
    if (part->map.find(stop)) return part.get();
  }
  return nullptr;
}

std::optional<UncertainPose> RobotParts::pose_of(const StopId& stop) const {
  const RobotPart* const part = part_of(stop);
  if (part == nullptr) return std::nullopt;
  return part->map.poses()[*part->map.find(stop)];
}

void RobotParts::end(RobotPart& part) {
  for (const auto& [with, meeting] : part.meetings) count(meeting.counts());
  part.meetings.clear();
  part.map.end();
  const std::uint32_t number = part.group;
  if (number == root()) return;
  const bool any = std::ranges::any_of(parts_, [&](const std::unique_ptr<RobotPart>& other) {
    return other->group == number && other->map.goes_on();
  });
  if (!any) drop(number);
}

void RobotParts::drop(std::uint32_t group) {
  std::erase_if(parts_, [&](const std::unique_ptr<RobotPart>& part) {
    if (part->group == group) count(part->map.counts());
    return part->group == group;
  });
  for (const std::unique_ptr<RobotPart>& part : parts_) part->meetings.erase(group);
  std::erase_if(links_, [&](const PartLink& link) {
    const bool gone = part_of(link.from) == nullptr || part_of(link.to) == nullptr;
    if (gone) linked_.erase({link.to, link.from});
    return gone;
  });
}

std::vector<RobotPart*> RobotParts::unite(std::uint32_t kept, std::uint32_t moved,
                                          const geometry::Pose2& T_kept_moved) {
  std::vector<RobotPart*> joining;
  for (const std::unique_ptr<RobotPart>& part : parts_) {
    for (const auto& [own, with] : {std::pair(kept, moved), std::pair(moved, kept)}) {
      const auto meeting = part->meetings.find(with);
      if (meeting == part->meetings.end()) continue;
      if (part->group == own) {
        for (const Sighting& sighting : meeting->second.sightings()) link(sighting);
      }
      count(meeting->second.counts());
      part->meetings.erase(meeting);
    }
    if (part->group != moved) continue;
    part->map.move(T_kept_moved);
    joining.push_back(part.get());
  }
  for (RobotPart* part : joining) {
    part->group = kept;
    part->meetings.erase(moved);
  }
  return joining;
}

std::vector<MapPart*> RobotParts::over(std::uint32_t number) const {
  std::vector<MapPart*> out;
  for (MapPart* part : group(number)) {
    if (!part->goes_on()) out.push_back(part);
  }
  return out;
}

void RobotParts::replace_over(std::uint32_t number, const StoredMap& map, const KeptViews& kept) {
  std::map<StopId, std::uint32_t> ids;
  for (const topomap::LocalMap& stop : map.maps) ids[stop.stop] = stop.id;
  const auto is_over = [&](const StopId& stop) { return ids.contains(stop); };
  // The measurements between them are part of the map.
  std::erase_if(links_,
                [&](const PartLink& link) { return is_over(link.from) && is_over(link.to); });
  const std::vector<topomap::StopPose>& stops = map.trajectory.stops;
  for (PartLink& link : links_) {
    const bool from = is_over(link.from);
    if (!from && !is_over(link.to)) continue;
    StopId& end = from ? link.from : link.to;
    const std::uint32_t id = ids.at(end);
    const std::uint32_t stands = kept.stands_for(id);
    if (stands == id) continue;
    const UncertainPose T_stands_stop{
        geometry::between(stops[stands].T_map_robot, stops[id].T_map_robot),
        usual_match_covariance()};
    link.T_from_to = from ? compose(T_stands_stop, link.T_from_to)
                          : compose(link.T_from_to, inverse(T_stands_stop));
    end = map.maps[stands].stop;
  }
  const auto pruned = std::make_shared<const StoredMap>(with_kept_views(map, kept));
  RobotPart* first = nullptr;
  for (const std::unique_ptr<RobotPart>& part : parts_) {
    if (part->group != number || part->map.goes_on()) continue;
    count(part->map.counts());
    if (first == nullptr) first = part.get();
  }
  first->map = MapPart(first->map.number(), pruned);
  first->robot.clear();
  std::erase_if(parts_, [&](const std::unique_ptr<RobotPart>& part) {
    return part->group == number && !part->map.goes_on() && part.get() != first;
  });
  for (const std::unique_ptr<RobotPart>& part : parts_) {
    const auto meeting = part->meetings.find(number);
    if (meeting != part->meetings.end()) meeting->second.renew();
  }
}

bool RobotParts::link(const Sighting& sighting) {
  if (!linked_.insert(std::pair(sighting.stop, sighting.other)).second) return false;
  links_.push_back({sighting.other, sighting.stop, EdgeKind::kRevisit, sighting.T_other_stop});
  return true;
}

void RobotParts::unlink(const StopId& stop) {
  std::erase_if(links_, [&](const PartLink& link) {
    const bool gone = link.kind == EdgeKind::kRevisit && link.to == stop;
    if (gone) linked_.erase({link.to, link.from});
    return gone;
  });
}

void RobotParts::drop_outvoted_links() {
  std::erase_if(links_, [&](const PartLink& link) {
    const std::optional<UncertainPose> from = pose_of(link.from);
    const std::optional<UncertainPose> to = pose_of(link.to);
    if (link.kind != EdgeKind::kRevisit || !from || !to) return false;
    const geometry::Pose2 now = geometry::between(from->T_a_b, to->T_a_b);
    return geometry::squared_mahalanobis(geometry::difference(now, link.T_from_to.T_a_b),
                                         invertible(link.T_from_to.covariance)) > kLinkOutvoted;
  });
}

SlamCounts RobotParts::counts() const {
  SlamCounts counts = gone_;
  for (const std::unique_ptr<RobotPart>& part : parts_) {
    add_counts(counts, part->map.counts());
    for (const auto& [with, meeting] : part->meetings) add_counts(counts, meeting.counts());
  }
  return counts;
}

}  // namespace topogeo::localization
