// Which of many doubtful loops are right, by how they agree: matches of several stops with an
// earlier stretch of path that all say the same are right together where none is beyond doubt
// alone (docs/algorithms.md, "Loops").
//
// Two loops agree when going round both of them, over the path between their ends, leads back to
// where it began, within the covariances. A set in which all agree with all is accepted as a whole
// when it is spread over some metres, heavy enough and much heavier than any other set for the
// same stretch. Hypotheses outlive optimisations: what they say is relative.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/localization/mapping/pose_graph.hpp"
#include "topogeo/localization/mapping/relative_poses.hpp"
#include "topogeo/localization/mapping/stop_match.hpp"

namespace topogeo::localization {

class LoopAgreement {
 public:
  /// Keeps a match as a hypothesis. `path_m`: from the first stop to each, all stops of the match
  /// included.
  void add(const StopMatch& match, std::span<const double> path_m);
  /// The same of a match that is accepted already: it speaks for those that agree with it, and
  /// against others.
  void add_accepted(const StopMatch& match, std::span<const double> path_m);

  /// The matches of sets that are accepted with those added since the last call, each once; they
  /// are hypotheses no longer, nor is what contradicts them.
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
  using Set = std::vector<std::size_t>;  // of indices, ascending

  /// What pairs are judged by: the paths between their ends, and between the earlier ends of
  /// loops with different visits of a place what the graph knows, where that was asked for.
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

/// Squared Mahalanobis distance of the way round two loops from the identity; their later and
/// earlier ends are each at most `farthest_m` of path apart, otherwise infinite.
double disagreement(const PoseGraph& graph, const PoseGraphEdge& a, const PoseGraphEdge& b,
                    std::span<const double> path_m, double farthest_m);
/// The same for any two, whose earlier ends lie like that: T_b.from_a.from.
double disagreement(const PoseGraph& graph, const PoseGraphEdge& a, const PoseGraphEdge& b,
                    const UncertainPose& T_from_b_from_a);

}  // namespace topogeo::localization
