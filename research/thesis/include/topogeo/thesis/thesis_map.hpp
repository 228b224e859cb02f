// The stops of the thesis's algorithm: maps, poses, overlaps and solutions of matches, the data of
// forward and backward correction.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/slam/pose_graph.hpp"
#include "topogeo/thesis/solution_store.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"
#include "topogeo/topomap/visible_rectangle.hpp"

namespace topogeo::localization {

struct ThesisStop {
  std::shared_ptr<const topomap::LocalMap> map;
  double path_m = 0.0;  ///< along the odometry from the first stop
  topomap::VisibleRectangle view;
  RangeProfile profile;
  std::vector<SurfacePoint> outline;
  std::vector<Eigen::Vector2d> landmarks_m;  ///< nodes and samples of branches, robot frame
  UncertainPose T_previous_this;             ///< by odometry
  std::vector<std::uint32_t> overlaps;       ///< MS, ascending
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of the pose in the map
};

/// An earlier map at its expected pose.
struct ThesisNeighbour {
  std::uint32_t id = 0;
  UncertainPose T_new_earlier;
  double overlap = 0.0;  ///< predicted share of the earlier map that the new one sees
};

/// A match of the newest stop with an earlier one.
struct ThesisMatch {
  std::uint32_t earlier = 0;
  MatchResult result;
  UncertainPose T_earlier_new;  ///< meaningless if nothing is in common
};

class ThesisMap {
 public:
  ThesisMap(const LocalizerConfig& config, std::uint32_t solutions_per_pair);

  /// Appends the next stop without its pose; place() or place_first() must follow.
  void append(std::shared_ptr<const topomap::LocalMap> map);
  void place_first();
  /// Places the last stop by a step from an earlier one; `match`: whether the step is a match.
  void place(std::uint32_t from, const UncertainPose& T_from_stop, bool match);

  [[nodiscard]] std::size_t size() const { return stops_.size(); }
  [[nodiscard]] const ThesisStop& stop(std::size_t id) const { return stops_[id]; }
  [[nodiscard]] const std::vector<geometry::Pose2>& poses() const { return graph_.poses(); }
  /// Relative poses; their covariances run along the matches between the stops.
  [[nodiscard]] std::vector<UncertainPose> relative_to(std::uint32_t origin) const {
    return graph_.relative_to(origin);
  }
  void set_overlaps(std::uint32_t stop, std::vector<std::uint32_t> overlaps) {
    stops_[stop].overlaps = std::move(overlaps);
  }

  /// Whether the distance driven from an earlier stop is short.
  [[nodiscard]] bool recent(std::uint32_t earlier, std::uint32_t stop) const;
  /// Steps 2 to 6 of Thesis, 7.3.1.1.1 (docs/algorithms.md, "Forward correction"): the earlier maps
  /// whose visible rectangle overlaps that of a stop at a pose, with enough in common for a match.
  /// `relative`: every earlier stop seen from that stop.
  [[nodiscard]] std::vector<ThesisNeighbour> neighbours(
      std::uint32_t stop, const geometry::Pose2& T_map_stop,
      std::span<const UncertainPose> relative) const;
  /// Whether the maps of two stops overlap at their current poses.
  [[nodiscard]] bool overlap_now(std::uint32_t earlier, std::uint32_t later) const;

  /// Stores the n best solutions of a match (definition 7.3.4): the refined one, then those of the
  /// search that lie elsewhere.
  void store(std::uint32_t stop, const ThesisMatch& match);
  /// The same in another store.
  void store_in(SolutionStore& store, std::uint32_t stop, const ThesisMatch& match) const;
  [[nodiscard]] SolutionStore& solutions() { return solutions_; }
  [[nodiscard]] const SolutionStore& solutions() const { return solutions_; }

  /// Adds a match that closed a cycle as an edge between the two stops.
  void add_closure(std::uint32_t stop, const ThesisMatch& match);
  /// Replaces all poses. The edges between stops hold the relative uncertainty of neighbours, which
  /// does not change.
  void move(const std::vector<geometry::Pose2>& T_map_robot);

  [[nodiscard]] topomap::StopPose pose_of(std::size_t stop) const;
  /// Grows with every change.
  [[nodiscard]] std::uint64_t version() const { return version_; }

 private:
  // Predicted share of the earlier map that the new one sees. Without scan points it is the share
  // of nodes and branches inside the field of view that the new map has from anywhere in its search
  // space, seen from the earlier one.
  [[nodiscard]] double expected_share(const ThesisStop& now, const ThesisStop& before,
                                      const UncertainPose& T_new_earlier,
                                      const topomap::VisibleRectangle& seen_from_earlier) const;

  LocalizerConfig config_;
  PoseGraph graph_;  // poses and their matches, only for uncertainties
  std::vector<ThesisStop> stops_;
  SolutionStore solutions_;
  std::uint64_t version_ = 0;
};

}  // namespace topogeo::localization
