// Fusion of the equivalent nodes of all views (Thesis, 7.3.2.1).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/global_map_builder.hpp"

#include "seen_region.hpp"
#include "spatial_index.hpp"

namespace topogeo::topomap {

/// A node fused from all views that saw it.
struct FusedNode {
  NodeKind kind = NodeKind::kReal;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< mean over the views, map frame (7.25)
  double clearance_m = 0.0;                              ///< mean over the views (7.26)
  std::uint32_t observations = 0;                        ///< number of views that saw it
  std::int64_t last_seen_ns = 0;                         ///< stamp of the last of them
  double weight_for = 0.0;      ///< the same, fading beyond GlobalMapConfig::memory_views
  double weight_against = 0.0;  ///< views of the place without it, fading alike
  std::int64_t last_view = -1;  ///< view that last updated it
};

/// True for kinds that can be one place seen differently.
bool compatible(NodeKind a, NodeKind b);

class NodeFusion {
 public:
  explicit NodeFusion(const GlobalMapConfig& config) : config_(config) {}

  /// Merges the nodes of one view into the fused nodes.
  void add(const LocalMap& map, const geometry::Pose2& T_map_robot, const SeenRegion& view,
           const Sighting& sighting);

  /// The index is the permanent id of the node.
  [[nodiscard]] const std::vector<FusedNode>& nodes() const { return nodes_; }

  /// Indices of the nodes within radius_m of a point, ascending.
  [[nodiscard]] std::vector<std::uint32_t> near(const Eigen::Vector2d& point_m,
                                                double radius_m) const;

 private:
  using IndexPoint = boost::geometry::model::d2::point_xy<double>;
  using Entry = std::pair<IndexPoint, std::uint32_t>;
  struct SameEntry {
    bool operator()(const Entry& a, const Entry& b) const {
      return a.second == b.second && a.first.x() == b.first.x() && a.first.y() == b.first.y();
    }
  };
  using Tree = boost::geometry::index::rtree<Entry, boost::geometry::index::quadratic<16>,
                                             boost::geometry::index::indexable<Entry>, SameEntry>;

  [[nodiscard]] std::optional<std::uint32_t> equivalent(const FusedNode& seen) const;
  void merge(std::uint32_t id, const FusedNode& seen);
  void vote_against(const geometry::Pose2& T_map_robot, const LocalMap& map,
                    const SeenRegion& view);
  void fade(FusedNode& node) const;

  GlobalMapConfig config_;
  std::vector<FusedNode> nodes_;
  Tree tree_;
  std::int64_t view_ = -1;
};

}  // namespace topogeo::topomap
