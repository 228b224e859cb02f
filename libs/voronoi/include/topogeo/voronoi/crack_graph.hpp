// Turns the nearest sites of the cells into ordered branches and nodes (Thesis, 4.2.2.3, eq.
// 4.19-4.25; docs/algorithms.md, "Local Voronoi diagram"). local_voronoi.hpp compares cracks with
// the cells of the Thesis.
//
// A crack is a border between cells of different groups. Cracks are followed from corner to corner
// of the grid. A corner where three groups meet is a node. If only two groups meet crosswise (a b /
// b a), the crack does not cross itself: the diagonal whose group is nearer at the corner stays
// connected. Nodes joined by a very short branch become one node at their mean.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/voronoi/generator_groups.hpp"
#include "topogeo/voronoi/nearest_site_grid.hpp"

namespace topogeo::voronoi {

struct DiagramPoint {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< laser frame
  double clearance_m = 0.0;                              ///< distance to both base groups
  /// How far the circle of the clearance reaches beyond the seen space (see Frontier). It is 0 if
  /// the whole circle was seen.
  double hidden_m = 0.0;
};

struct DiagramNode {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< laser frame
  double clearance_m = 0.0;
  double hidden_m = 0.0;  ///< as in DiagramPoint
  /// The equally near groups: a run of LocalVoronoiDiagram::node_groups, ascending. It has at least
  /// three entries, rarely more than four.
  PointRun base_groups;
};

struct DiagramBranch {
  static constexpr std::uint32_t kLoose = 0xffffffff;  ///< an end at the border of what is visible
  std::uint32_t node_a = kLoose;                       ///< node at the first point, or kLoose
  std::uint32_t node_b = kLoose;                       ///< node at the last point, or kLoose
  std::array<std::uint16_t, 2> base_groups{};          ///< the two nearest groups, ascending
  /// Points [begin, end) of LocalVoronoiDiagram::points, ordered from node_a to node_b and
  /// including the positions of the nodes; at least two.
  PointRun points;
};

struct LocalVoronoiDiagram {
  GeneratorGroups groups;          ///< groups of the scan, followed by virtual groups
  std::vector<DiagramNode> nodes;  ///< each has a branch
  std::vector<DiagramBranch> branches;
  std::vector<DiagramPoint> points;        ///< points of all branches
  std::vector<std::uint16_t> node_groups;  ///< base groups of all nodes
  bool is_virtual = false;                 ///< built because fewer than two groups meet in view

  [[nodiscard]] std::span<const DiagramPoint> points_of(const DiagramBranch& branch) const {
    return {points.data() + branch.points.begin, branch.points.size()};
  }
  [[nodiscard]] std::span<const std::uint16_t> groups_of(const DiagramNode& node) const {
    return {node_groups.data() + node.base_groups.begin, node.base_groups.size()};
  }
};

/// Follows the cracks of a grid. An object can be used again, which saves allocations.
class CrackGraph {
 public:
  /// Replaces the nodes, node groups, branches and points of `out`.
  void trace(const NearestSiteGrid& grid, std::span<const Site> sites, const VoronoiConfig& config,
             LocalVoronoiDiagram& out);

 private:
  /// A branch during tracing; its ends are corners.
  struct Piece {
    std::uint32_t corner_a = 0;
    std::uint32_t corner_b = 0;
    std::uint32_t node_a = 0;
    std::uint32_t node_b = 0;
    std::array<std::uint16_t, 2> base_groups{};
    PointRun points;
    double length_m = 0.0;
    bool dropped = false;
  };
  /// A corner where three or more groups meet.
  struct Junction {
    std::uint32_t corner = 0;
    Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
    double clearance_m = 0.0;
    std::array<std::uint16_t, 4> groups{};
    int group_count = 0;
    std::uint32_t merged_into = 0;  ///< index of this or an earlier junction
  };

  void find_cracks();
  void find_junctions();
  void trace_pieces();
  void trace_from(std::uint32_t corner, int direction);
  void merge_junctions(double longest_m);
  void drop_short_pieces(double shortest_m);
  void write(LocalVoronoiDiagram& out);
  void write_nodes(LocalVoronoiDiagram& out);
  void write_node_groups(LocalVoronoiDiagram& out);

  [[nodiscard]] std::array<int, 2> row_col(std::uint32_t corner) const;
  [[nodiscard]] std::array<std::uint16_t, 4> sites_around(std::uint32_t corner) const;
  [[nodiscard]] Junction make_junction(std::uint32_t corner) const;
  [[nodiscard]] int next_direction(std::uint32_t corner, int arrived) const;
  [[nodiscard]] std::uint32_t step(std::uint32_t corner, int direction) const;
  [[nodiscard]] DiagramPoint crack_point(std::uint32_t corner, int direction,
                                         std::array<std::uint16_t, 2>& groups) const;
  [[nodiscard]] std::uint32_t root_of(std::uint32_t junction) const;
  void append(const DiagramPoint& point, Piece& piece);

  const NearestSiteGrid* grid_ = nullptr;
  std::span<const Site> sites_;
  std::uint32_t stride_ = 0;                ///< corners in a row of corners
  std::vector<std::uint8_t> cracks_;        ///< per corner: a bit for each direction
  std::vector<std::uint8_t> used_;          ///< per corner: the bits of the traced cracks
  std::vector<std::uint32_t> corners_;      ///< corners with at least one crack
  std::vector<std::uint32_t> junction_at_;  ///< per corner: index + 1, or 0
  std::vector<Junction> junctions_;
  std::vector<Piece> pieces_;
  std::vector<DiagramPoint> points_;
  std::vector<std::uint32_t> node_of_;  ///< per junction: index of its node
  std::vector<int> members_;            ///< per junction: number of junctions merged into it
  struct NodeGroup {
    std::uint32_t node = 0;
    std::uint16_t group = 0;
    friend auto operator<=>(const NodeGroup&, const NodeGroup&) = default;
  };
  std::vector<NodeGroup> node_groups_;
};

}  // namespace topogeo::voronoi
