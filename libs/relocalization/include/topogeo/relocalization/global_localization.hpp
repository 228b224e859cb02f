// Pose of a scan in a finished map without any prior (docs/algorithms.md, "Localization in a
// finished map (own)").
//
// Poses at every place that was seen free, in every heading, are scored against a coarse field of
// the whole map. The best of them climb in a fine field, and the best of those are aligned point to
// line with the stored stops that have the same view. The aligned view is the evidence and the best
// pose elsewhere the rival: in a corridor another place fits as well, which the verdict states.
// Seeds on branches and nodes alone, as in the Thesis, were no better on real logs and miss a robot
// in the middle of a hall.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/place_field.hpp"
#include "topogeo/matching/refinement.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

/// A fitting pose with its evidence.
struct GlobalPose {
  geometry::Pose2 T_map_robot;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< in the map frame
  double fitness = 0.0;     ///< soft share of the scan that lies on surfaces of the map, [0, 1]
  double inliers = 0.0;     ///< against the stored stop that sees most of the scan, [0, 1]
  double violations = 0.0;  ///< the same
  double doubt = 0.0;       ///< the same
  std::uint32_t stop = 0;   ///< id of that stop
};

struct GlobalAnswer {
  Verdict verdict = Verdict::kRejected;
  double rivalry = 0.0;           ///< fitness of the second pose over that of the first
  std::vector<GlobalPose> poses;  ///< distinct, best first
};

/// Shares of the points of a scan.
struct KnownView {
  double there = 0.0;         ///< on a surface of the map
  double contradicted = 0.0;  ///< a stop of the map saw past them
  [[nodiscard]] double known() const { return there + contradicted; }
};

/// A stored stop, reduced to the data for global localization.
struct StoredStop {
  std::uint32_t id = 0;
  geometry::Pose2 T_map_robot;
  RangeProfile profile;
};

class GlobalLocalizer {
 public:
  /// `maps[i]` is the local map of `trajectory.stops[i]`; both must outlive the localizer. Throws
  /// std::invalid_argument for a map without stops or points, or with fewer maps than stops.
  GlobalLocalizer(std::span<const topomap::LocalMap> maps, const topomap::Trajectory& trajectory);

  /// Possible poses of a scan (points in the robot frame). The same on every machine.
  [[nodiscard]] GlobalAnswer find(std::span<const topomap::ScanPoint> points,
                                  const geometry::Pose2& T_robot_laser) const;

  /// First half of find(), for callers that delegate the work: the questions to field() about
  /// points in the robot frame, seen in one scan or over several metres of path.
  [[nodiscard]] std::vector<std::shared_ptr<const PlaceQuestion>> questions(
      const std::vector<SurfacePoint>& seen) const;
  /// The `count` best distinct places in the answers to questions().
  [[nodiscard]] static std::vector<Climbed> distinct(std::vector<MatchSolution> places,
                                                     std::size_t count);
  [[nodiscard]] const std::shared_ptr<const PlaceField>& field() const { return field_; }

  /// Index of the stored stop that sees most of a scan; without any, the nearest one. `share` gets
  /// the part that it sees, [0, 1].
  [[nodiscard]] std::size_t best_stop(const MatchFeatures& query,
                                      const geometry::Pose2& T_map_robot, double& share) const;

  [[nodiscard]] const std::vector<StoredStop>& stops() const { return stops_; }
  /// Soft share of scan points on surfaces of the map, [0, 1].
  [[nodiscard]] double fitness(const MatchFeatures& query,
                               const geometry::Pose2& T_map_robot) const;
  /// Compares a scan, as taken from a pose, with the stored stops.
  [[nodiscard]] KnownView known_view(const MatchFeatures& query,
                                     const geometry::Pose2& T_map_robot) const;

 private:
  [[nodiscard]] std::vector<std::uint8_t> free_cells(const PlaceField& field) const;
  [[nodiscard]] GlobalPose aligned(const MatchFeatures& query, const Climbed& place) const;

  std::span<const topomap::LocalMap> maps_;
  std::vector<StoredStop> stops_;
  std::shared_ptr<const PlaceField> field_;
};

/// Whether two poses are one place: nearer than 0.5 m and 15 degrees.
bool same_global_place(const geometry::Pose2& a, const geometry::Pose2& b);

}  // namespace topogeo::localization
