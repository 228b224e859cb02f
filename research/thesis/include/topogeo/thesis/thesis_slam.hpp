// The thesis's own algorithm alone (Thesis, 7.3.1; docs/algorithms.md, "Forward correction" and
// "Backward correction"), for comparison with the pose graph of pose_graph_slam.hpp: forward
// correction at each stop, backward correction when a cycle closes (CycleClosing).
//
// Each pose is that of the one match with the largest fitness (eq. 7.18); nothing is averaged, and
// only a closed cycle moves older poses. With thesis.kept_solutions, forward and backward
// correction stay apart as in figures 8.15 to 8.22: each backward correction starts from the
// forward poses, and the trajectory is the best kept solution (KeptSolutions). Differences from the
// print, with reasons:
// - matches pass the same gate as everywhere, because one poor match in a turn costs more than all
//   good ones give; a match that the gate only doubts is used if there is no better one;
// - the uncertainty of a pose relative to an earlier one runs along the matches between them, not
//   along the odometry alone, by which everything would overlap after a hundred metres.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/slam/slam.hpp"
#include "topogeo/thesis/cycle_closing.hpp"
#include "topogeo/thesis/kept_solutions.hpp"
#include "topogeo/thesis/thesis_config.hpp"
#include "topogeo/thesis/thesis_map.hpp"
#include "topogeo/thesis/thesis_matching.hpp"

namespace topogeo::localization {

class ThesisSlam : public Slam {
 public:
  /// Reads from `config`: seed, odometry, the settings of matches and their gate, recent_way_m,
  /// revisit_matches (maps seen again that are matched per step; 0: cycles stay open),
  /// smallest_expected_overlap, largest_half_width_* and unaided_correction_*. The pool must
  /// outlive this.
  ThesisSlam(const ThesisSlamConfig& config, MatchPool& pool);

  bool add(std::shared_ptr<const topomap::LocalMap> map) override;
  /// Refines the kept solutions; does nothing without any.
  void finish() override;

  [[nodiscard]] topomap::Trajectory trajectory() const override;
  [[nodiscard]] std::optional<topomap::StopPose> last_stop() const override;
  /// With kept solutions only the match that placed the stops of the best one.
  [[nodiscard]] std::vector<topomap::LoopClosure> loop_closures() const override;
  [[nodiscard]] const std::vector<LoopDecision>& loop_decisions() const override {
    return cycles_.decisions();
  }
  /// The confidence is the fitness of the match that placed the stop, halved if the gate doubted
  /// it; the thesis has no calibrated one.
  [[nodiscard]] LocalizationStatus status() const override { return status_; }
  [[nodiscard]] SlamCounts counts() const override;

  /// Poses of all stops: by the best kept solution, otherwise those of the map.
  [[nodiscard]] const std::vector<geometry::Pose2>& poses() const;

  // For inspection of the origin of a pose. With kept solutions the map has the forward poses.
  [[nodiscard]] const ThesisMap& map() const { return map_; }
  [[nodiscard]] const KeptSolutions& kept() const { return kept_; }
  [[nodiscard]] const CycleClosing& cycles() const { return cycles_; }

 private:
  void correct_forward();
  [[nodiscard]] std::vector<ThesisNeighbour> forward_neighbours();
  const ThesisMatch* best_of(const std::vector<ThesisMatch>& matches);

  ThesisSlamConfig config_;
  ThesisMap map_;
  ThesisMatching matching_;
  CycleClosing cycles_;
  KeptSolutions kept_;
  std::uint64_t kept_version_ = 0;
  LocalizationStatus status_;
  std::uint64_t steps_in_doubt_ = 0;
};

}  // namespace topogeo::localization
