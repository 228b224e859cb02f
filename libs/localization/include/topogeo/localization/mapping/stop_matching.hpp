// Matches stops of one map with earlier ones: chooses the pairs, makes the tasks and returns the
// relative pose that each measured.
//
// All answers of one round are awaited before any is used, so the result does not depend on who
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

#include "topogeo/localization/mapping/candidate_choice.hpp"
#include "topogeo/localization/mapping/covariance_calibration.hpp"
#include "topogeo/localization/mapping/localizer_config.hpp"
#include "topogeo/localization/mapping/match_requests.hpp"
#include "topogeo/localization/mapping/pose_graph.hpp"
#include "topogeo/localization/mapping/stop_comparisons.hpp"
#include "topogeo/localization/mapping/stop_match.hpp"
#include "topogeo/localization/matching/match.hpp"
#include "topogeo/localization/matching/match_features.hpp"
#include "topogeo/localization/places/place_recognition.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

class StopMatching {
 public:
  /// The pool must outlive this.
  StopMatching(const LocalizerConfig& config, MatchPool& pool);

  /// Appends a stop, whose id is its index; `distance_m` from the one before, along the odometry.
  void add(std::shared_ptr<const topomap::LocalMap> map, double distance_m);

  [[nodiscard]] std::size_t size() const { return stops_.size(); }
  [[nodiscard]] const topomap::LocalMap& map(std::size_t stop) const { return *stops_[stop].map; }
  /// Along the odometry from the first stop to this one.
  [[nodiscard]] double path_m(std::size_t stop) const { return path_m_[stop]; }
  [[nodiscard]] std::span<const double> path_m() const { return path_m_; }

  /// Matches of the last stop with recent ones; once more in a wider space when none is accepted,
  /// because odometry may be worse than configured. The pose of the last stop in the graph is the
  /// predicted one.
  std::vector<StopMatch> match_recent(const PoseGraph& graph);
  /// Matches of the last stop where odometry knows too little of all recent ones but the stop just
  /// before for match_recent(): after a long step that nobody mapped that one may show nothing, and
  /// others much. Recent ones, or those of an earlier visit where no recent one would show much.
  /// Each is widened, as no search is as wide as odometry is uncertain.
  std::vector<StopMatch> match_unsearchable(const PoseGraph& graph);
  /// Matches of stops with such that are not recent to them. The tasks of all make one round.
  std::vector<StopMatch> match_revisited(const PoseGraph& graph,
                                         std::span<const std::uint32_t> stops);

  /// The two stops need no match: how they lie is known.
  void skip(const PoseGraphEdge& known);
  /// The two stops may be matched again.
  void reopen(const PoseGraphEdge& edge) { comparisons_.forget(edge.from, edge.to); }
  /// The next stop does not follow the last one: its search starts from nothing.
  void forget_solutions() { last_solutions_.clear(); }

  /// What the triangles of matches say of their covariances.
  [[nodiscard]] const CovarianceCalibration& calibration() const { return calibration_; }

  [[nodiscard]] MatchRequests& requests() { return requests_; }
  [[nodiscard]] const MatchRequests& requests() const { return requests_; }

 private:
  struct Stop {
    std::shared_ptr<const topomap::LocalMap> map;
    std::shared_ptr<const StopView> view;
  };
  /// A task and what it is for.
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
  /// For the last stop, by what they would show if odometry were right.
  [[nodiscard]] CandidateChoice shown_if_right(std::span<const std::uint32_t> candidates,
                                               const RelativePoses& relative) const;
  [[nodiscard]] std::vector<MatchCandidate> revisited_candidates(
      const PoseGraph& graph, std::uint32_t stop, std::span<const std::uint32_t> candidates,
      const RelativePoses& relative) const;
  void consider(CandidateChoice& choice, const PoseGraph& graph, std::uint32_t earlier,
                std::uint32_t stop, const UncertainPose& T_stop_earlier, bool common) const;
  /// Those before the last one, ascending.
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
  std::set<std::uint32_t> recognized_;  // stops that places were asked for, in this round
  std::optional<std::uint32_t> recognized_last_;
  std::vector<StopMatch> windows_;  // of the places of this round
  std::uint32_t misfits_ = 0;       // stops in succession at which no match fitted its prediction
  std::set<std::uint32_t> revisited_;  // stops that were matched where they were predicted
  StopComparisons comparisons_;
  CovarianceCalibration calibration_;
  /// T_later_earlier of accepted matches with recent stops, by (earlier, later).
  std::map<std::pair<std::uint32_t, std::uint32_t>, UncertainPose> recent_;
  /// Of the last stop's matches with recent ones, by the id of the older map: where the search for
  /// the next stop against the same map starts.
  std::map<std::uint32_t, std::vector<MatchSolution>> last_solutions_;
};

}  // namespace topogeo::localization
