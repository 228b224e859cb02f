// Drives shared by several experiments, each made on first use.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/slam/slam.hpp"
#include "topogeo/thesis/thesis_slam.hpp"
#include "topogeo/topomap/global_map.hpp"
#include "topogeo/topomap/global_map_config.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/world/world.hpp"

#include "reproduce/measured.hpp"

namespace topogeo::reproduce {

/// The stops of a simulated drive. Poses are in the frame of the first stop.
struct Drive {
  world::World world;
  geometry::Pose2 T_world_first;
  std::vector<std::shared_ptr<const topomap::LocalMap>> stops;
  std::vector<geometry::Pose2> truth;
  std::vector<geometry::Pose2> odometry;
  std::vector<double> path_m;  ///< driven up to each stop
  double perception_ms = 0.0;  ///< mean time of a diagram and local map
  double range_m = 0.0;        ///< of the readings in diagrams and maps
  [[nodiscard]] std::vector<topomap::LocalMap> maps() const;
};

/// The corrections of a drive by the Thesis's algorithm.
struct Correction {
  localization::ThesisSlamConfig config;
  std::unique_ptr<localization::MatchPool> pool;
  std::unique_ptr<localization::ThesisSlam> slam;
  std::vector<std::vector<geometry::Pose2>> poses_after;  ///< [k]: all poses after stop k
  std::vector<std::vector<std::uint32_t>> overlaps;       ///< [k]: set MS of stop k, at stop k
  std::vector<bool> closed;  ///< [k]: whether stop k moved earlier poses
  /// Backward correction at stop k: poses of all its solutions, best first; the loop begins at the
  /// stop `first`.
  struct Backward {
    std::size_t stop = 0;
    std::size_t first = 0;
    std::vector<localization::LoopPath> paths;
    localization::BackwardProblem problem;
    std::vector<geometry::Pose2> before;  ///< poses by the forward correction
  };
  std::vector<Backward> backward;
  /// With kept solutions: those of stop k once it is added, best first, as poses of all stops.
  std::vector<std::vector<std::vector<geometry::Pose2>>> kept;
  double wall_s = 0.0;

  [[nodiscard]] const localization::ThesisMap& map() const { return slam->map(); }
  [[nodiscard]] const std::vector<geometry::Pose2>& final_poses() const {
    return poses_after.back();
  }
};

/// How a drive is corrected: by default with the preset of the Thesis (thesis.config.yaml), nodes
/// and branches alone.
struct CorrectionKind {
  bool backward = true;  ///< whether cycles are closed
  bool kept = true;  ///< whether distinct solutions are kept; otherwise the best becomes the map
  localization::FitnessForm form = localization::FitnessForm::kTopological;
  /// Condition for a match to pass; kFitness accepts every match with a fitness, as printed.
  localization::MatchEvidence evidence = localization::MatchEvidence::kFitness;
  bool calibrated = true;  ///< noise of the odometry of the preset; otherwise the default
  friend auto operator<=>(const CorrectionKind&, const CorrectionKind&) = default;
};

/// The better means of the product: scan points refine a match, and a gate accepts it.
inline constexpr CorrectionKind kProduct{.kept = false,
                                         .form = localization::FitnessForm::kCombined,
                                         .evidence = localization::MatchEvidence::kScan,
                                         .calibrated = false};
inline constexpr CorrectionKind kForwardAlone{.backward = false};
inline constexpr CorrectionKind kProductForward{.backward = false,
                                                .kept = false,
                                                .form = localization::FitnessForm::kCombined,
                                                .evidence = localization::MatchEvidence::kScan,
                                                .calibrated = false};
/// The printed form; each backward correction becomes the trajectory at once.
inline constexpr CorrectionKind kSingleWalk{.kept = false,
                                            .form = localization::FitnessForm::kPrinted};

/// "topological form, no gate, no scan points".
std::string matcher_text(const localization::LocalizerConfig& config);
/// Values of a drive alone, without any match.
Means means_of(const Drive& drive);
Means means_of(const Drive& drive, const Correction& correction);

/// One drive of experiment 2 and back to its start with this seed, as "loop".
Drive loop_drive(std::uint64_t seed);
Correction correct_loop(const Drive& drive, const CorrectionKind& kind = {});

class SharedRuns {
 public:
  /// "corridor": experiment 1 with a stop every 1.3 m; "positions": its first 24 m with a stop
  /// every 2.4 m; "turn": up to its turn with 45 stops, one every 0.66 m; "loop": experiment 2 with
  /// a stop every 1.5 m, and back to its start; "apart": experiment 1 with stops so far apart and
  /// ranges so short that local maps do not overlap; "door": a corridor with a door that opens. All
  /// but "apart" have 4 m of range and the local maps of the Thesis; "corridor, 10 m", "positions,
  /// 10 m", "loop, 10 m" and "door, 10 m" have 10 m and those of the product. Throws
  /// std::invalid_argument for any other name.
  const Drive& drive(const std::string& name);
  const Correction& correction(const std::string& drive, const CorrectionKind& kind = {});

 private:
  std::map<std::string, Drive> drives_;
  std::map<std::pair<std::string, CorrectionKind>, Correction> corrections_;
};

/// Largest and last errors of poses against the truth.
struct PoseErrors {
  double mean_m = 0.0;
  double largest_m = 0.0;
  double last_m = 0.0;
  double last_rad = 0.0;
};
PoseErrors pose_errors(const std::vector<geometry::Pose2>& poses,
                       const std::vector<geometry::Pose2>& truth);

/// The global map of the first `count` stops at these poses, fused by default as in the Thesis
/// (7.25 to 7.27).
topomap::GlobalMap fused(const Drive& drive, const std::vector<geometry::Pose2>& poses,
                         std::size_t count, topomap::FusionRule rule = topomap::FusionRule::kPairs);

}  // namespace topogeo::reproduce
