// Start poses for a genetic search: each lays a branch or a node of the query map on an equivalent
// one of the reference map.
//
// Two branch samples of like clearance and their directions give a pose (and a second one turned by
// half a turn); two nodes of like clearance give one with the predicted heading. Where the maps
// agree, the poses of many pairs coincide: each cell of the search space counts its pairs, and the
// fullest cells are the hypotheses. A whole-map search from a random start converges to the wrong
// place far more often than one from these poses.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/matching/match_features.hpp"

namespace topogeo::localization {

class BranchHypotheses {
 public:
  /// At most task.genetic.branch_hypotheses poses inside the search space, most likely first, no
  /// two of them the same solution. Valid until the next call. Does not allocate after a task of
  /// the same size.
  std::span<const geometry::Pose2> find(const MatchTask& task, const MatchFeatures& reference,
                                        const MatchFeatures& query);

 private:
  struct Candidate {
    std::uint64_t cell;
    float weight;
    geometry::Pose2 T_reference_query;
  };
  struct Cell {
    std::uint64_t cell;
    double weight;      // of all its candidates
    std::size_t first;  // its heaviest candidate
  };
  class Space;

  void add_branches(const Space& space, const MatchFeatures& reference, const MatchFeatures& query);
  void add_nodes(const Space& space, const MatchFeatures& reference, const MatchFeatures& query);
  void count_cells();

  std::vector<Candidate> candidates_;
  std::vector<Cell> cells_;
  std::vector<geometry::Pose2> poses_;
};

}  // namespace topogeo::localization
