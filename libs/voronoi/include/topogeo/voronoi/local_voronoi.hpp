// The local Voronoi diagram of one laser scan, in the laser frame (Thesis, chapter 4;
// docs/algorithms.md, "Local Voronoi diagram").
//
// Every reading of a group is a site, and so are points between distant readings of one wall. A
// branch is the crack between visible neighbour cells whose nearest sites belong to different
// groups; a node is a corner of cells where three groups meet. That gives ordered curves one cell
// wide. The rule of the Thesis (every cell whose two smallest group distances differ by less than 2
// E_max) gives bands, and whole wedges behind a gap between two groups: there the distances to both
// groups grow almost alike, so the rule holds over an area. The crack through a wedge is the line
// where they are equal. Every point is moved from the cell border to the place between the two cell
// centres where both distances are equal, so positions are far more precise than a cell.
//
// A diagram of fewer than two groups, or of groups that do not meet in view, is virtual (4.2.1): it
// serves navigation and is never matched. With one group a line of virtual points is added on the
// other side of the robot, parallel to the motion; without groups, two lines. A virtual diagram is
// empty if no space is free.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/scan/scan.hpp"
#include "topogeo/voronoi/crack_graph.hpp"
#include "topogeo/voronoi/frontier.hpp"
#include "topogeo/voronoi/generator_groups.hpp"
#include "topogeo/voronoi/nearest_site_grid.hpp"
#include "topogeo/voronoi/voronoi_config.hpp"

namespace topogeo::voronoi {

/// Makes diagrams of the scans of one laser. A work space: its tables stay valid while the scan
/// geometry stays the same, and its results depend on the scan alone.
class LocalVoronoi {
 public:
  /// Throws std::invalid_argument if a field of the configuration is outside its range.
  explicit LocalVoronoi(const VoronoiConfig& config);

  /// The diagram of `scan` in the laser frame. Throws std::invalid_argument if the angles of the
  /// scan are invalid (see BeamDirections) or its groups have more than 65,534 sites.
  LocalVoronoiDiagram compute(const scan::Scan& scan);
  /// The same into `out`, which keeps its capacity.
  void compute(const scan::Scan& scan, LocalVoronoiDiagram& out);

  [[nodiscard]] const VoronoiConfig& config() const { return config_; }
  /// The cells of the last scan, for pictures and tests.
  [[nodiscard]] const NearestSiteGrid& grid() const { return grid_; }
  /// The readings of all groups of the last scan and the points between them on walls.
  [[nodiscard]] std::span<const Site> sites() const { return sites_; }
  /// Empty if the last diagram is virtual.
  [[nodiscard]] const Frontier& frontier() const { return frontier_; }
  /// Free range of each beam of the last scan, metres. For a virtual diagram it is assumed: up to
  /// its lines, and up to the range limit without an echo.
  [[nodiscard]] std::span<const double> free_range_m() const { return free_range_m_; }

 private:
  void measure_free_space(const scan::Scan& scan);
  void trace(LocalVoronoiDiagram& diagram);
  void drop_tight_ends(LocalVoronoiDiagram& diagram) const;
  void place_sites(const GeneratorGroups& groups);
  void place_sites(const GeneratorGroups& groups, double spacing_m);
  void measure_hidden_depths(LocalVoronoiDiagram& diagram);

  VoronoiConfig config_;
  BeamDirections beams_;
  NearestSiteGrid grid_;
  CrackGraph cracks_;
  Frontier frontier_;
  std::vector<double> free_range_m_;
  std::vector<Site> sites_;
};

}  // namespace topogeo::voronoi
