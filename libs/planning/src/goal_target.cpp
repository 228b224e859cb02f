#include "goal_target.hpp"

#include <string>
#include <vector>

#include "topogeo/planning/place_names.hpp"

#include "route_ends.hpp"

namespace topogeo::planning {
namespace {

std::string no_such_place(const std::vector<Place>& places, const std::string& name) {
  std::string reason = "no place has the name '" + name + "'";
  if (places.empty()) return reason + ", the map has none";
  constexpr std::size_t kMostNames = 5;
  reason += places.size() > kMostNames ? "; similar names:" : "; the places are";
  const char* before = " '";
  for (const std::string& similar : similar_names(places, name, kMostNames)) {
    reason += before + similar + "'";
    before = ", '";
  }
  return reason;
}

}  // namespace

GoalTarget resolve(const HybridMap* map, const Target& to) {
  GoalTarget goal;
  if (const auto* point = std::get_if<Eigen::Vector2d>(&to)) {
    goal.point_m = *point;
  } else if (const auto* node = std::get_if<NodeNumber>(&to)) {
    const std::size_t nodes = map == nullptr ? 0 : map->nodes().size();
    goal.known = node->id < nodes;
    if (goal.known) {
      // Its position is on the border; the cell on one side is always passable.
      goal.point_m = map->frame().center_m(map->nodes()[node->id].cells[0]);
    } else {
      goal.failure = no_route(RouteStatus::kUnknownNode,
                              "no node has the number " + std::to_string(node->id) +
                                  ", the map has " + std::to_string(nodes) + " nodes");
    }
  } else {
    static const std::vector<Place> kNone;
    const std::vector<Place>& places = map == nullptr ? kNone : map->places();
    const std::string& name = std::get<std::string>(to);
    const Place* place = find_place(places, name);
    goal.known = place != nullptr;
    if (goal.known) {
      goal.point_m = place->position_m;
    } else {
      goal.failure = no_route(RouteStatus::kUnknownPlace, no_such_place(places, name));
    }
  }
  return goal;
}

}  // namespace topogeo::planning
