// Matches the stops of a map with earlier ones: chooses the pairs, makes the tasks and returns the
// measured relative poses.
//
// A round waits for all its answers before any is used, so the result does not depend on who
// answered or when.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/slam/candidate_choice.hpp"
#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/slam/match_requests.hpp"
#include "topogeo/slam/place_recognition.hpp"
#include "topogeo/slam/pose_graph.hpp"
#include "topogeo/topomap/local_map.hpp"

#include "covariance_calibration.hpp"
#include "loop/stop_match.hpp"
#include "stop_comparisons.hpp"

namespace topogeo::localization {

class StopMatching {
 public:
  /// The pool must outlive this.
  StopMatching(const LocalizerConfig& config, MatchPool& pool);

  /// Appends a stop, whose id is its index; `distance_m` from the previous one, along the odometry.
  void add(std::shared_ptr<const topomap::LocalMap> map, double distance_m);

  [[nodiscard]] std::size_t size() const { return stops_.size(); }
  [[nodiscard]] const topomap::LocalMap& map(std::size_t stop) const { return *stops_[stop].map; }
  /// Path length along the odometry from the first stop to this one.
  [[nodiscard]] double path_m(std::size_t stop) const { return path_m_[stop]; }
  [[nodiscard]] std::span<const double> path_m() const { return path_m_; }

  /// Matches of the last stop with recent ones. If none is accepted, they are repeated in a wider
  /// space, because odometry may be worse than configured. The prediction is the pose of the last
  /// stop in the graph.
  std::vector<StopMatch> match_recent(const PoseGraph& graph);
  /// Matches of the last stop when odometry is too uncertain for match_recent() to search any
  /// recent stop but the previous one: after a long unmapped step that stop may have no view in
  /// common, and others much. Compares with recent stops, or with those of an earlier visit if no
  /// recent one would have much in common. All are marked as widened, because the search space is
  /// smaller than the uncertainty.
  std::vector<StopMatch> match_unsearchable(const PoseGraph& graph);
  /// Matches of stops with stops that are not recent for them, all tasks in one round.
  std::vector<StopMatch> match_revisited(const PoseGraph& graph,
                                         std::span<const std::uint32_t> stops);

  /// Marks two stops as matched: their relative pose is known.
  void skip(const PoseGraphEdge& known);
  /// Allows two stops to be matched again.
  void reopen(const PoseGraphEdge& edge) { comparisons_.forget(edge.from, edge.to); }
  /// The next stop does not follow the last one, so its search starts without earlier solutions.
  void forget_solutions() { last_solutions_.clear(); }

  /// Calibration of match covariances by triangles of matches.
  [[nodiscard]] const CovarianceCalibration& calibration() const { return calibration_; }

  [[nodiscard]] MatchRequests& requests() { return requests_; }
  [[nodiscard]] const MatchRequests& requests() const { return requests_; }

 private:
  struct Stop {
    std::shared_ptr<const topomap::LocalMap> map;
    std::shared_ptr<const StopView> view;
  };
  /// A task and its origin.
  struct Comparison {
    MatchTask task;
    UncertainPose T_later_earlier;  // as predicted
    ProposalSource source = ProposalSource::kPrediction;
  };

  [[nodiscard]] std::uint32_t last_stop() const {
    return static_cast<std::uint32_t>(stops_.size() - 1);
  }
  [[nodiscard]] std::uint32_t first_recent(std::uint32_t stop) const;
  [[nodiscard]] std::vector<MatchCandidate> recent_candidates(const PoseGraph& graph,
                                                              const RelativePoses& relative) const;
  /// Candidates for the last stop by the overlap they would have if odometry were right.
  [[nodiscard]] CandidateChoice shown_if_right(std::span<const std::uint32_t> candidates,
                                               const RelativePoses& relative) const;
  [[nodiscard]] std::vector<MatchCandidate> revisited_candidates(
      const PoseGraph& graph, std::uint32_t stop, std::span<const std::uint32_t> candidates,
      const RelativePoses& relative) const;
  void consider(CandidateChoice& choice, const PoseGraph& graph, std::uint32_t earlier,
                std::uint32_t stop, const UncertainPose& T_stop_earlier, bool common) const;
  /// Recent stops before the last one, ascending.
  [[nodiscard]] std::vector<std::uint32_t> recent_stops() const;
  std::vector<MatchTask> recent_tasks(const PoseGraph& graph, const RelativePoses& relative,
                                      std::span<const MatchCandidate> candidates, double widening);
  std::vector<StopMatch> run(std::span<const MatchTask> tasks, EdgeKind kind);
  void calibrate(std::span<const StopMatch> matches);
  [[nodiscard]] bool wants_places(std::uint32_t stop) const;
  std::vector<Comparison> comparisons_with_places(const PoseGraph& graph, std::uint32_t stop,
                                                  std::span<const UncertainPose> relative);
  [[nodiscard]] StopMatch judged(const MatchTask& task, const MatchResult& result,
                                 EdgeKind kind) const;

  LocalizerConfig config_;
  MatchRequests requests_;
  std::vector<Stop> stops_;
  std::vector<double> path_m_;  // along the odometry, of each stop
  PlaceRecognition places_;
  std::set<std::uint32_t> recognized_;  // stops queried for places in this round
  std::optional<std::uint32_t> recognized_last_;
  std::vector<StopMatch> windows_;     // of the places of this round
  std::uint32_t misfits_ = 0;          // successive stops without a match near its prediction
  std::set<std::uint32_t> revisited_;  // stops matched at their prediction
  StopComparisons comparisons_;
  CovarianceCalibration calibration_;
  /// T_later_earlier of accepted matches with recent stops, by (earlier, later).
  std::map<std::pair<std::uint32_t, std::uint32_t>, UncertainPose> recent_;
  /// Solutions of the last stop's matches with recent ones, by the id of the older map: the search
  /// for the next stop against the same map starts there.
  std::map<std::uint32_t, std::vector<MatchSolution>> last_solutions_;
};

}  // namespace topogeo::localization
