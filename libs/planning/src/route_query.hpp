// One query of the hybrid planner with a valid start and goal.
#pragma once

#include <span>
#include <vector>

#include "topogeo/planning/hybrid_planner.hpp"

#include "closed_cells.hpp"
#include "open_network.hpp"

namespace topogeo::planning {

class RouteQuery {
 public:
  /// `closed`: nodes and edges that must not be used. All arguments must outlive it.
  RouteQuery(const HybridMap& map, const HybridPlannerConfig& config, const ClosedParts& closed,
             const ClosedCells& cells)
      : map_(map), config_(config), closed_(closed), cells_(cells), network_(map, closed, cells) {}

  /// Sets kind, cells, nodes and edges; no cells if no path connects the two open cells.
  [[nodiscard]] HybridRoute run(const Cell& from, const Cell& to) const;

  /// Whether slow or one-way zones on the path may favour another one, or forbid this one. If it
  /// touches none of them, it remains the cheapest.
  [[nodiscard]] bool needs_rules(std::span<const Cell> cells) const;
  /// Like run(), by one search of the whole grid that obeys the rules of zones.
  [[nodiscard]] HybridRoute run_by_rules(const Cell& from, const Cell& to) const;

  /// The cheapest route that obeys all rules; no cells if there is none.
  [[nodiscard]] HybridRoute obedient(const Cell& from, const Cell& to) const;

  /// Like OpenNetwork::within_reach, in the directions that one-way zones allow.
  [[nodiscard]] std::vector<bool> within_reach(const Cell& from) const;

  /// Like `straighten`, around closed parts.
  [[nodiscard]] std::vector<Eigen::Vector2d> straightened(std::span<const Cell> cells,
                                                          const Eigen::Vector2d& from_m,
                                                          const Eigen::Vector2d& to_m) const;

 private:
  struct Reach;

  [[nodiscard]] Reach reach(const Cell& cell, ZoneId zone) const;
  [[nodiscard]] HybridRoute within(const Cell& from, const Cell& to, ZoneId zone) const;
  [[nodiscard]] std::vector<Cell> cells_within(const Cell& from, const Cell& to, ZoneId zone) const;
  [[nodiscard]] HybridRoute across(const Cell& from, const Cell& to, ZoneId zone_from,
                                   ZoneId zone_to) const;
  void follow(const GraphPath& path, const Reach& start, const Reach& goal,
              HybridRoute& route) const;
  void improve(HybridRoute& route) const;
  void name_nodes_and_edges(HybridRoute& route) const;
  [[nodiscard]] bool improve_whole(std::vector<Cell>& cells) const;
  void improve_pieces(std::vector<Cell>& cells) const;
  [[nodiscard]] bool plan_again(std::vector<Cell>& cells, std::size_t begin, std::size_t end,
                                std::int32_t margin) const;
  [[nodiscard]] CellBox box_around(const Cell& a, const Cell& b, std::int32_t margin) const;
  void close_parts(SearchWindow& window, ZoneId keep) const;
  [[nodiscard]] bool uses_closed_edge(std::span<const Cell> cells) const;

  const HybridMap& map_;
  const HybridPlannerConfig& config_;
  const ClosedParts& closed_;
  const ClosedCells& cells_;
  OpenNetwork network_;
};

}  // namespace topogeo::planning
