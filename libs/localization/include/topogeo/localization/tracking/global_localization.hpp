// Where in a finished map a scan was taken, without any idea of it before
// (docs/algorithms.md, "Localization in a finished map (own)").
//
// Poses in every place that was seen free, in every heading, are scored against a coarse field of
// the whole map; the best of them climb in a fine one, the best of those are aligned point to line
// with the stored stops that look in the same direction. What is seen there is the evidence, and
// the best pose elsewhere the rival: in a corridor another place fits as well, and the verdict is
// so. Seeds on branches and nodes alone, as the Thesis has them, were no better on real logs and
// miss a robot in the middle of a hall.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/matching/match.hpp"
#include "topogeo/localization/matching/match_features.hpp"
#include "topogeo/localization/matching/refinement.hpp"
#include "topogeo/localization/places/place_field.hpp"
#include "topogeo/localization/tracking/map_field.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

/// A pose that fits, with the evidence.
struct GlobalPose {
  geometry::Pose2 T_map_robot;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< in the map frame
  double fitness = 0.0;     ///< share of the scan that lies on what the map has, softly, [0, 1]
  double inliers = 0.0;     ///< against the stored stop that sees most of the scan, [0, 1]
  double violations = 0.0;  ///< the same
  double doubt = 0.0;       ///< the same
  std::uint32_t stop = 0;   ///< id of that stop
};

struct GlobalAnswer {
  Verdict verdict = Verdict::kRejected;
  double rivalry = 0.0;           ///< of the second pose, share of the first one's fitness
  std::vector<GlobalPose> poses;  ///< distinct, best first
};

/// Shares of the points of a scan.
struct KnownView {
  double there = 0.0;         ///< where the map has something
  double contradicted = 0.0;  ///< where a stop of the map saw past
  [[nodiscard]] double known() const { return there + contradicted; }
};

/// A stored stop as global localization needs it.
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

  /// Where a scan (points in the robot frame) may have been taken. The same on every machine.
  [[nodiscard]] GlobalAnswer find(std::span<const topomap::ScanPoint> points,
                                  const geometry::Pose2& T_robot_laser) const;

  /// What find() does before it compares places closely, for those who have others do the work: the
  /// questions to field() about what was seen, points in the robot frame, of one scan or of
  /// several metres of path, ...
  [[nodiscard]] std::vector<std::shared_ptr<const PlaceQuestion>> questions(
      const std::vector<SurfacePoint>& seen) const;
  /// ... and the `count` best distinct ones of the places in their answers.
  [[nodiscard]] static std::vector<Climbed> distinct(std::vector<MatchSolution> places,
                                                     std::size_t count);
  [[nodiscard]] const std::shared_ptr<const PlaceField>& field() const { return field_; }

  /// Index of the stored stop from which most of a scan is seen; nothing is seen from any: the
  /// nearest one. `share` takes how much, [0, 1].
  [[nodiscard]] std::size_t best_stop(const MatchFeatures& query,
                                      const geometry::Pose2& T_map_robot, double& share) const;

  [[nodiscard]] const std::vector<StoredStop>& stops() const { return stops_; }
  /// Share of scan points on what the map has, softly, [0, 1].
  [[nodiscard]] double fitness(const MatchFeatures& query,
                               const geometry::Pose2& T_map_robot) const;
  /// What the stored stops say of a scan as it would be taken from a pose.
  [[nodiscard]] KnownView known_view(const MatchFeatures& query,
                                     const geometry::Pose2& T_map_robot) const;

 private:
  [[nodiscard]] std::vector<std::uint8_t> free_cells(const PlaceField& field) const;
  [[nodiscard]] GlobalPose aligned(const MatchFeatures& query, const Climbed& place) const;

  std::span<const topomap::LocalMap> maps_;
  std::vector<StoredStop> stops_;
  std::shared_ptr<const PlaceField> field_;
};

/// Two poses are one place when they are nearer than 0.5 m and 15 degrees.
bool same_global_place(const geometry::Pose2& a, const geometry::Pose2& b);

}  // namespace topogeo::localization
