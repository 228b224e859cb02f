// Lasting names for the branches of the global map.
//
// Each snapshot extracts the map again, so its branches have no identity of their own. Each local
// branch that passes no anchor yet leaves one at its middle, far from the junctions and ends that
// move a little with every view; the lowest anchor on a branch of the map names it.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/local_map.hpp"

#include "spatial_index.hpp"

namespace topogeo::topomap {

class BranchNames {
 public:
  static constexpr double kReach_m = 0.5;  ///< limit between an anchor and the branch that it names

  /// Adds anchors for the branches of one view that are real, on the main graph and unnamed.
  void add(const LocalMap& map, const geometry::Pose2& T_map_robot);

  /// Anchors by name, map frame.
  [[nodiscard]] const std::vector<Eigen::Vector2d>& anchors() const { return anchors_; }

 private:
  using IndexPoint = boost::geometry::model::d2::point_xy<double>;
  using Entry = std::pair<IndexPoint, std::uint32_t>;

  [[nodiscard]] bool named(const LocalBranch& branch, const geometry::Pose2& T_map_robot) const;

  std::vector<Eigen::Vector2d> anchors_;
  boost::geometry::index::rtree<Entry, boost::geometry::index::quadratic<16>> tree_;
};

}  // namespace topogeo::topomap
