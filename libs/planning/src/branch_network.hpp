// The topo-geometric map as a search graph: its nodes, and branches cut where routes enter and
// leave.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/planning/route_planner.hpp"
#include "topogeo/topomap/global_map.hpp"

#include "branch_access.hpp"
#include "branch_rules.hpp"

namespace topogeo::planning {

/// The cheapest path between accesses, with the indices of its first and last one.
struct NetworkPath {
  Route route;
  std::size_t from = 0;  ///< index among the entries
  std::size_t to = 0;    ///< index among the exits
};

class BranchNetwork {
 public:
  /// Both must outlive it. A piece of a branch is closed if its clearance is less than
  /// min_clearance_m and it is not virtual, or if the rules close it.
  BranchNetwork(const topomap::GlobalMap& map, double min_clearance_m, const BranchRules& rules);
  ~BranchNetwork();

  /// The path between any two accesses with the least total cost of both and the pieces between.
  [[nodiscard]] std::optional<NetworkPath> cheapest(std::span<const BranchAccess> entries,
                                                    std::span<const BranchAccess> exits);
  /// The same between two nodes of the map, by MapNode::id, which must exist.
  [[nodiscard]] std::optional<Route> between_nodes(std::uint32_t from, std::uint32_t to);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace topogeo::planning
