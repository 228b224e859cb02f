// The source's own algorithm alone (spec A6 and A7, thesis 7.3.1), for comparison with the pose
// graph of localizer.hpp: forward correction at each stop, backward correction when a cycle closes.
//
// Each pose is that of the one match with the largest fitness (7.18); nothing is averaged, and only
// a closed cycle moves older poses. What differs from the print, and why:
// - matches pass the same gate as everywhere, since one poor match in a turn costs more than all
//   good ones give; what the gate only doubts is taken when nothing better is there;
// - the uncertainty of a pose relative to an earlier one runs along the matches between them, not
//   along the odometry alone, which after a hundred metres would let everything overlap;
// - a recent map that comes back into the overlap set (it flickers at the threshold) closes no
//   cycle;
// - the walk back ends at the oldest of the maps seen again, as a candidate says nothing of the
//   poses before it.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "topogeo/localization/mapping/localizer.hpp"
#include "topogeo/localization/mapping/pose_graph.hpp"
#include "topogeo/localization/mapping/slam.hpp"
#include "topogeo/localization/matching/match.hpp"
#include "topogeo/localization/matching/match_features.hpp"
#include "topogeo/localization/thesis/backward_correction.hpp"
#include "topogeo/localization/thesis/solution_store.hpp"
#include "topogeo/localization/thesis/visible_rectangle.hpp"

namespace topogeo::localization {

/// What only the source's algorithm asks for; the reasons stand beside the numbers.
struct ThesisConfig {
  std::uint32_t matches = 8;  ///< of a new map with those that it overlaps with, best first: more
                              ///< of them hardly ever hold the fittest match
  std::uint32_t cycle_solutions = 40;  ///< per map seen again, as in the source
  std::uint32_t alternations = 3;      ///< of forward and backward in one step, at most
  BackwardConfig backward;
};

class ThesisLocalizer : public Slam {
 public:
  /// Of `config` it reads seed, odometry, the settings of matches and their gate, recent_way_m,
  /// revisit_matches (maps seen again that are matched per step; 0: cycles stay open),
  /// smallest_expected_overlap, largest_half_width_* and unaided_correction_*. The pool must
  /// outlive the localizer.
  ThesisLocalizer(const LocalizerConfig& config, MatchPool& pool, const ThesisConfig& thesis = {});

  bool add(std::shared_ptr<const topomap::LocalMap> map) override;
  /// Nothing: the source has no work that waits for the end.
  void finish() override {}

  [[nodiscard]] topomap::Trajectory trajectory() const override;
  [[nodiscard]] std::optional<topomap::StopPose> last_stop() const override;
  [[nodiscard]] std::vector<topomap::LoopClosure> loop_closures() const override {
    return closures_;
  }
  [[nodiscard]] const std::vector<LoopDecision>& loop_decisions() const override {
    return decisions_;
  }
  /// The confidence is the fitness of the match that placed the stop, halved where the gate
  /// doubted it; the source has no other, and none is calibrated.
  [[nodiscard]] Belief belief() const override { return belief_; }
  [[nodiscard]] SlamCounts counts() const override { return counts_; }

 private:
  struct Stop {
    std::shared_ptr<const topomap::LocalMap> map;
    std::uint64_t hash = 0;
    double way_m = 0.0;  // along the odometry from the first stop
    VisibleRectangle view;
    RangeProfile profile;
    std::vector<SurfacePoint> outline;
    UncertainPose T_previous_this;                         // by odometry
    std::vector<std::uint32_t> overlaps;                   // MS, ascending
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of the pose in the map
  };

  [[nodiscard]] topomap::StopPose pose_of(std::size_t stop) const;
  /// An earlier map as it is expected to lie.
  struct Neighbour {
    std::uint32_t id = 0;
    UncertainPose T_new_earlier;
    double overlap = 0.0;  // share of the earlier map that the new one should see
  };
  struct Match {
    std::uint32_t earlier = 0;
    MatchResult result;
    UncertainPose T_earlier_new;
  };

  void append(std::shared_ptr<const topomap::LocalMap> map);
  [[nodiscard]] std::vector<Neighbour> neighbours(std::uint32_t stop,
                                                  const geometry::Pose2& T_map_predicted,
                                                  std::span<const UncertainPose> relative) const;
  [[nodiscard]] bool recent(std::uint32_t earlier, std::uint32_t stop) const;
  std::vector<Match> match(std::uint32_t stop, const std::vector<Neighbour>& with,
                           std::uint32_t solutions);
  void store(std::uint32_t stop, const Match& match);
  void forward(std::uint32_t stop);
  bool close_cycles(std::uint32_t stop);
  bool close_cycle(std::uint32_t stop, const std::vector<Neighbour>& seen_again);
  [[nodiscard]] std::vector<BackwardCandidate> candidates(const std::vector<Match>& matches,
                                                          std::uint32_t first) const;
  [[nodiscard]] BackwardProblem backward_problem(std::uint32_t first, std::uint32_t stop) const;
  void apply(const BackwardProblem& problem, const LoopPath& way);
  void move(const std::vector<geometry::Pose2>& T_map_robot);
  void decide(std::uint32_t stop, const Match& match, LoopOutcome outcome,
              const geometry::Pose2& T_map_before);

  LocalizerConfig config_;
  ThesisConfig thesis_;
  MatchPool& pool_;
  PoseGraph graph_;  // poses and the matches that placed them, for uncertainties alone
  std::vector<Stop> stops_;
  SolutionStore store_;
  std::map<std::uint32_t, std::vector<MatchSolution>> last_solutions_;  // by the older map
  std::vector<topomap::LoopClosure> closures_;
  std::vector<LoopDecision> decisions_;
  std::uint64_t version_ = 0;
  std::uint64_t next_task_ = 0;
  Belief belief_;
  SlamCounts counts_;
};

}  // namespace topogeo::localization
