// Finds the right ones among many doubtful loops by their agreement: matches of several stops with
// an earlier stretch of path that agree are right together, even if none of them is beyond doubt
// alone (docs/algorithms.md, "Loops").
//
// Two loops agree when the round trip over both, along the path between their ends, returns to its
// start within the covariances. A set in which every pair agrees is accepted as a whole when it is
// spread over some metres, heavy enough and much heavier than any other set for the same stretch.
// Hypotheses stay valid after optimisations, because they are relative.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/slam/pose_graph.hpp"

#include "loop/stop_match.hpp"

namespace topogeo::localization {

class LoopAgreement {
 public:
  /// Keeps a match as a hypothesis. `path_m`: path length from the first stop to each stop, up to
  /// those of the match.
  void add(const StopMatch& match, std::span<const double> path_m);
  /// Like add() for an accepted match: it supports hypotheses that agree with it and opposes
  /// others.
  void add_accepted(const StopMatch& match, std::span<const double> path_m);

  /// Returns the matches of the sets that the hypotheses added since the last call complete, each
  /// match once, and drops the hypotheses that contradict them.
  std::vector<StopMatch> accepted(const PoseGraph& graph, std::span<const double> path_m);

  [[nodiscard]] std::size_t waiting() const { return hypotheses_.size(); }

 private:
  struct Hypothesis {
    StopMatch match;
    double weight = 0.0;
    bool fresh = true;
    bool accepted = false;
  };
  void keep(Hypothesis hypothesis, std::span<const double> path_m);
  using Set = std::vector<std::size_t>;  // indices, ascending

  /// Data to judge pairs by: the paths between their ends and, on demand, the relative poses in the
  /// graph between earlier ends at different visits of a place.
  struct Ways {
    const PoseGraph& graph;
    std::span<const double> path_m;
    RelativePoses T_seed_stop{};
  };
  [[nodiscard]] const PoseGraphEdge& edge_of(std::size_t i) const {
    return hypotheses_[i].match.edge;
  }
  [[nodiscard]] double disagreement(std::size_t a, std::size_t b, const Ways& ways) const;
  [[nodiscard]] Set set_around(std::size_t seed, std::span<const std::size_t> among,
                               const Ways& ways) const;
  [[nodiscard]] std::vector<std::uint32_t> other_visits(std::size_t seed, const Ways& ways) const;
  [[nodiscard]] bool is_heavy(const Set& set, std::span<const double> path_m) const;
  [[nodiscard]] Set rivals_of(std::size_t seed, const Set& set, const Ways& ways) const;
  [[nodiscard]] double weight_of(const Set& set, std::span<const double> path_m) const;
  [[nodiscard]] double surprise_of(const Set& set) const;
  [[nodiscard]] bool spread(const Set& set, std::span<const double> path_m) const;

  std::vector<Hypothesis> hypotheses_;
};

/// Squared Mahalanobis distance of the round trip over two loops from the identity. Infinite if
/// their later or their earlier ends are more than `farthest_m` of path apart.
double disagreement(const PoseGraph& graph, const PoseGraphEdge& a, const PoseGraphEdge& b,
                    std::span<const double> path_m, double farthest_m);
/// The same for two loops whose earlier ends have this relative pose (T_b.from_a.from).
double disagreement(const PoseGraph& graph, const PoseGraphEdge& a, const PoseGraphEdge& b,
                    const UncertainPose& T_from_b_from_a);

}  // namespace topogeo::localization
