// Input and output of a search for the relative pose of two local maps (docs/algorithms.md, "Search
// pool").
//
// A task contains everything that its answer depends on, so any worker gives the same answer. Poses
// are T_reference_query: the robot at the query map's stop, in the frame of the reference map's
// stop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match_config.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

/// Asks where in a whole map the points seen from one place may lie; one part of that search (see
/// PlaceField).
struct PlaceQuestion {
  struct Piece {
    std::uint32_t map_id = 0;
    std::uint64_t content_hash = 0;
  };
  std::uint64_t field_hash = 0;            ///< of the whole map
  std::vector<Piece> pieces;               ///< pieces of the map, as sent
  std::uint32_t wall_pieces = 0;           ///< the first of the pieces, which are walls
  double margin_m = 0.0;                   ///< around the walls
  std::vector<topomap::ScanPoint> points;  ///< in the robot frame
  std::uint32_t first_heading = 0;         ///< first heading that the part searches
  std::uint32_t headings = 0;              ///< number of headings
};

struct MatchTask {
  std::uint64_t task_id = 0;  ///< unique within one run of one robot
  std::uint32_t reference_map_id = 0;
  std::uint32_t query_map_id = 0;
  std::uint64_t reference_hash = 0;  ///< content_hash of the reference map
  std::uint64_t query_hash = 0;
  geometry::Pose2 T_reference_query;  ///< predicted; centre of the search space
  Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Zero();  ///< of the prediction, (x, y, theta) in the reference frame
  Eigen::Vector3d half_width = Eigen::Vector3d::Zero();  ///< of the search space: m, m, rad
  GeneticParameters genetic;
  FitnessForm fitness_form = FitnessForm::kCombined;
  MatchEvidence evidence = MatchEvidence::kScan;
  std::vector<geometry::Pose2>
      initial_individuals;             ///< T_reference_query candidates besides the prediction
  std::uint32_t solutions_wanted = 3;  ///< n best distinct solutions, 1 to 40
  GateConfig gate;
  std::uint64_t seed = 0;
  /// Not null: a part of a search of the whole map instead of a match. Then only task_id and the
  /// querying stop (query_map_id, query_hash) count among the fields above.
  std::shared_ptr<const PlaceQuestion> places;
};

struct MatchSolution {
  geometry::Pose2 T_reference_query;
  double fitness = 0.0;  ///< in [0, 1]
  friend bool operator==(const MatchSolution&, const MatchSolution&) = default;
};

enum class MatchStatus : std::uint8_t {
  kSolved = 0,
  kNothingInCommon = 1,  ///< no point of the query map is in view of the reference map
};

/// Whether a match is accepted.
enum class Verdict : std::uint8_t {
  kAccepted = 0,
  kAmbiguous = 1,  ///< another place fits nearly as well
  kRejected = 2,
};

/// Why a match is not accepted.
enum class Reason : std::uint8_t {
  kNone = 0,  ///< accepted
  kNothingInCommon,
  kLittleOverlap,
  kFewInliers,
  kDoubtful,
  kImplausible,     ///< far from the prediction
  kSecondSolution,  ///< the maps allow another pose as well; with kAmbiguous
};

inline constexpr std::size_t kReasons = 7;

/// A pose with all the evidence for it. Everything but `second`, `solutions` (as a selection) and
/// `evaluations` can be recomputed from the task and the poses: see Matcher::verify.
struct MatchResult {
  std::uint64_t task_id = 0;
  MatchStatus status = MatchStatus::kNothingInCommon;
  /// Best first, distinct, before refinement. The only answer to MatchTask::places.
  std::vector<MatchSolution> solutions;
  geometry::Pose2
      T_reference_query;  ///< best solution after refinement by MatchTask::evidence with the prior
  Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Zero();  ///< of T_reference_query from the data alone (inverse Hessian with
                                ///< a floor), (x, y, theta) in the reference frame; zero unless
                                ///< solved
  double overlap = 0.0;  ///< share of the query's points inside the view of the reference, [0, 1]
  double inliers = 0.0;  ///< of those, share within the inlier distance of a reference line, [0, 1]
  double violations = 0.0;  ///< of those, share where the reference saw free space instead, [0, 1]
  double residual_rms_m = 0.0;
  double scan_fitness = 0.0;  ///< of the refined pose, without the prior, [0, 1]; the task's form
                              ///< if no scan point counts
  double topological_fitness = 0.0;  ///< of the refined pose, without the prior, [0, 1]
  double fitness = 0.0;              ///< of the refined pose, [0, 1]
  MatchSolution second;  ///< best other pose in the search space by the maps alone, without
                         ///< odometry; fitness 0: none
  std::uint32_t evaluations = 0;
  std::uint64_t seed = 0;  ///< of the task
  Verdict verdict = Verdict::kRejected;
  Reason reason = Reason::kNothingInCommon;
};

class PlaceField;

/// Works on match tasks: in this process or on any number of machines.
class MatchPool {
 public:
  MatchPool() = default;
  MatchPool(const MatchPool&) = delete;
  MatchPool& operator=(const MatchPool&) = delete;
  virtual ~MatchPool() = default;

  /// Registers a local map, so that tasks can name it.
  virtual void add_map(std::shared_ptr<const topomap::LocalMap> map) = 0;

  /// Registers a whole map for PlaceQuestion::field_hash in place of the previous one. Pools
  /// without such tasks need none.
  // NOLINTNEXTLINE(performance-unnecessary-value-param): pools that need one keep it
  virtual void add_field(std::shared_ptr<const PlaceField> /*field*/) {}

  /// Results in the order of the tasks, whatever the order of the work. Every map that a task names
  /// must have been added before. Throws std::runtime_error if it cannot answer.
  virtual std::vector<MatchResult> match(std::span<const MatchTask> tasks) = 0;
};

// Equality to the last bit, for values that must not differ between machines. Unlike with ==, 0 and
// -0 differ, and a NaN equals itself.

bool identical(double a, double b);
bool identical(const geometry::Pose2& a, const geometry::Pose2& b);
/// Compares every field.
bool identical(const MatchResult& a, const MatchResult& b);

}  // namespace topogeo::localization
