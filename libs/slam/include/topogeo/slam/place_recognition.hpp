// Finds earlier places that look like the view of the last metres (docs/algorithms.md, "Places").
//
// One scan of a corridor looks like another; five metres of a drive with their doors and ends do so
// much less. The view of the last metres is searched, coarsely, in submaps: pieces of the older
// path with everything seen from them, fixed once they are complete. The results are only
// proposals, which a match of two stops has to confirm.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/coarse_search.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/slam/pose_graph.hpp"
#include "topogeo/support/recently_used.hpp"

namespace topogeo::localization {

/// View from a stop, in the frame of the robot.
struct StopView {
  RangeProfile profile;
  std::vector<SurfacePoint> outline;  ///< some of its points, to predict overlap
  std::vector<SurfacePoint> near;     ///< points within kNear_m, about 0.2 m apart

  static constexpr double kNear_m = 15.0;
};

StopView view_of(MatchFeatures features);

/// An earlier place that the robot may be at.
struct PlaceProposal {
  std::uint32_t anchor = 0;      ///< stop that defines the frame of the poses
  std::uint32_t first_stop = 0;  ///< of the submap
  std::uint32_t last_stop = 0;
  geometry::Pose2 T_anchor_robot;    ///< as found
  UncertainPose predicted;           ///< the same as predicted
  std::uint32_t first_of_query = 0;  ///< first stop whose view was part of the query
  /// T_anchor_robot after alignment of the whole query with the submap, with the covariance of
  /// match_covariance(); zero if too little is in common.
  UncertainPose aligned;
  double value =
      0.0;  ///< after alignment: share of the points in view of the submap that it also has, [0, 1]
  double seen = 0.0;  ///< share of the points in view of the submap, [0, 1]
};

/// The covariance within which a place is searched, from that of its prediction.
Eigen::Matrix3d widened_for_places(const Eigen::Matrix3d& predicted);

/// View of the last metres, thinned.
struct PlaceQuery {
  PlaceQuery() = default;
  /// Points in the frame of the robot.
  explicit PlaceQuery(std::vector<SurfacePoint> seen);

  MatchFeatures whole;                    ///< for the comparison; only the surface
  std::vector<Eigen::Vector2d> coarse_m;  ///< for the search
};

class PlaceRecognition {
 public:
  /// Path whose view makes a query.
  static constexpr double kQuery_m = 5.0;

  /// Appends a stop, whose number is its index; `path_m`: path from the first stop.
  void add(std::shared_ptr<const StopView> view, double path_m);

  /// Searches submaps of stops before `first_recent` around the possible positions of `stop` for
  /// the view of the last metres before it. Best first; of each submap all places that fit about as
  /// well. `relative`: poses of the stops seen from `stop`. Leaves out submaps whose anchor is
  /// known better than `least_sigma_m` on both axes.
  std::vector<PlaceProposal> propose(const PoseGraph& graph, std::uint32_t stop,
                                     std::uint32_t first_recent,
                                     std::span<const UncertainPose> relative, double least_sigma_m);

 private:
  struct Submap {
    std::uint32_t first = 0;  // stops
    std::uint32_t last = 0;
    std::uint32_t anchor = 0;
    std::vector<geometry::Pose2> T_anchor_stop;  // for the stops first to last
    std::vector<geometry::Pose2> T_stop_anchor;
  };
  struct Query {
    std::vector<SurfacePoint> points;  // in the frame of the last stop
    std::uint32_t first_stop = 0;
  };
  struct Target;

  void cut(std::span<const geometry::Pose2> T_map_stop, std::uint32_t first_recent);
  void add_submap(std::span<const geometry::Pose2> T_map_stop, std::uint32_t first,
                  std::uint32_t last);
  [[nodiscard]] std::vector<SurfacePoint> points_of(const Submap& submap) const;
  [[nodiscard]] Query query(const PoseGraph& graph, std::uint32_t stop) const;
  const CoarseMap& map_of(std::size_t submap);
  const Reference& reference_of(std::size_t submap);
  [[nodiscard]] PlaceProposal proposal_in(std::size_t submap,
                                          const geometry::Pose2& T_anchor_robot) const;
  [[nodiscard]] std::vector<Target> targets(std::uint32_t first_recent,
                                            std::span<const UncertainPose> relative,
                                            double least_sigma_m) const;
  std::vector<PlaceProposal> places_in(const Target& target, const PlaceQuery& query);
  void align_with(std::size_t submap, const MatchFeatures& query, PlaceProposal& proposal);
  void count_seen(const Submap& submap, const Reference& reference, const MatchFeatures& query,
                  PlaceProposal& proposal) const;

  std::vector<std::shared_ptr<const StopView>> views_;
  std::vector<double> path_m_;
  std::vector<Submap> submaps_;
  std::uint32_t next_first_ = 0;                     // of the next submap
  support::RecentlyUsed<CoarseMap> maps_{64};        // of about 60 kB
  support::RecentlyUsed<Reference> references_{32};  // of about 1 MB
};

}  // namespace topogeo::localization
