// Matches the newest stop of the thesis's algorithm with earlier ones.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/slam/match_requests.hpp"
#include "topogeo/thesis/thesis_map.hpp"

namespace topogeo::localization {

class ThesisMatching {
 public:
  /// The pool must outlive this.
  ThesisMatching(const LocalizerConfig& config, MatchPool& pool) : requests_(config, pool) {}

  /// Registers the last stop of the map with the pool.
  void add(const ThesisMap& map);
  /// Matches the last stop with its neighbours for this many solutions each.
  std::vector<ThesisMatch> match(const ThesisMap& map, std::span<const ThesisNeighbour> with,
                                 std::uint32_t solutions);
  /// Stores the solutions at which searches of the next stop against the same maps start.
  void remember(std::span<const ThesisMatch> matches);

  [[nodiscard]] const MatchCounts& counts() const { return requests_.counts(); }

 private:
  MatchRequests requests_;
  std::map<std::uint32_t, std::vector<MatchSolution>> last_solutions_;  // by the older map
};

}  // namespace topogeo::localization
