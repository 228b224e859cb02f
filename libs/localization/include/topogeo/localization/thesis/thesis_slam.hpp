// The thesis's own algorithm alone (Thesis, 7.3.1; docs/algorithms.md, "Forward correction" and
// "Backward correction"), for comparison with the pose graph of pose_graph_slam.hpp: forward
// correction at each stop, backward correction when a cycle closes (CycleClosing).
//
// Each pose is that of the one match with the largest fitness (eq. 7.18); nothing is averaged, and
// only a closed cycle moves older poses. Differences from the print, with reasons:
// - matches pass the same gate as everywhere, because one poor match in a turn costs more than all
//   good ones give; a match that the gate only doubts is used if there is no better one;
// - the uncertainty of a pose relative to an earlier one runs along the matches between them, not
//   along the odometry alone, by which everything would overlap after a hundred metres.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "topogeo/localization/mapping/localizer_config.hpp"
#include "topogeo/localization/mapping/slam.hpp"
#include "topogeo/localization/matching/match.hpp"
#include "topogeo/localization/thesis/cycle_closing.hpp"
#include "topogeo/localization/thesis/thesis_map.hpp"
#include "topogeo/localization/thesis/thesis_matching.hpp"

namespace topogeo::localization {

class ThesisSlam : public Slam {
 public:
  /// Reads from `config`: seed, odometry, the settings of matches and their gate, recent_way_m,
  /// revisit_matches (maps seen again that are matched per step; 0: cycles stay open),
  /// smallest_expected_overlap, largest_half_width_* and unaided_correction_*. The pool must
  /// outlive this.
  ThesisSlam(const LocalizerConfig& config, MatchPool& pool);

  bool add(std::shared_ptr<const topomap::LocalMap> map) override;
  /// Does nothing: the thesis has no work that waits for the end.
  void finish() override {}

  [[nodiscard]] topomap::Trajectory trajectory() const override;
  [[nodiscard]] std::optional<topomap::StopPose> last_stop() const override;
  [[nodiscard]] std::vector<topomap::LoopClosure> loop_closures() const override {
    return cycles_.closures();
  }
  [[nodiscard]] const std::vector<LoopDecision>& loop_decisions() const override {
    return cycles_.decisions();
  }
  /// The confidence is the fitness of the match that placed the stop, halved if the gate doubted
  /// it; the thesis has no calibrated one.
  [[nodiscard]] LocalizationStatus status() const override { return status_; }
  [[nodiscard]] SlamCounts counts() const override;

  // For inspection of the origin of a pose.
  [[nodiscard]] const ThesisMap& map() const { return map_; }
  [[nodiscard]] const CycleClosing& cycles() const { return cycles_; }

 private:
  void correct_forward();
  [[nodiscard]] std::vector<ThesisNeighbour> forward_neighbours();
  const ThesisMatch* best_of(const std::vector<ThesisMatch>& matches);

  LocalizerConfig config_;
  ThesisMap map_;
  ThesisMatching matching_;
  CycleClosing cycles_;
  LocalizationStatus status_;
  std::uint64_t steps_in_doubt_ = 0;
};

}  // namespace topogeo::localization
