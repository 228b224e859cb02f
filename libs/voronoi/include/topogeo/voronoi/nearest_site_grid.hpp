// The nearest site of every visible cell of a grid around the laser (Thesis, 4.2.2.1 and
// 4.2.2.2, eq. 4.14-4.16; docs/algorithms.md, "Local Voronoi diagram").
//
// One exact Euclidean distance transform over the sites of all groups at once: along a row of cells
// the squared distance to site i is f_i - 2 u u_i + u^2, so the nearest sites are the lower convex
// hull of the points (u_i, f_i). This is the parabola envelope of Felzenszwalb and Huttenlocher for
// sites that do not lie on cell centres, which costs rows x sites instead of cells x sites and no
// rounding of the sites to cells. A unit test compares it with brute force.
//
// Rows run along x (forward), columns along y (left), both in the laser frame; the laser is at the
// corner of four cells.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/voronoi/generator_groups.hpp"

namespace topogeo::voronoi {

struct Site {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< laser frame
  std::uint16_t group = 0;
};

class NearestSiteGrid {
 public:
  static constexpr std::uint16_t kNone = 0xffff;

  /// Makes the table of the beam through each cell. Takes some milliseconds; call it when the scan
  /// geometry or the configuration changes.
  void set_geometry(const BeamDirections& beams, const VoronoiConfig& config);

  /// Finds the nearest site of every cell whose centre is nearer than `free_range_m` of its beam.
  /// `free_range_m` has one value per beam, 0 if nothing is known to be free. The window of cells
  /// is the extent of the free space, or of the sites (4.14). Ties go to the site with the smaller
  /// y, then to the earlier one. Without sites there are no cells. Throws std::invalid_argument for
  /// more than 65,534 sites.
  void compute(std::span<const Site> sites, std::span<const double> free_range_m);

  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int cols() const { return cols_; }
  [[nodiscard]] double resolution_m() const { return resolution_m_; }
  /// Centre of a cell, laser frame.
  [[nodiscard]] Eigen::Vector2d centre(int row, int col) const {
    return {(first_x_ + row + 0.5) * resolution_m_, (first_y_ + col + 0.5) * resolution_m_};
  }
  /// Site index, kNone if the cell is not visible.
  [[nodiscard]] std::uint16_t site(int row, int col) const { return sites_[index(row, col)]; }
  /// Group of that site, kNone if the cell is not visible.
  [[nodiscard]] std::uint16_t group(int row, int col) const { return groups_[index(row, col)]; }
  /// The groups of one row, cols() values.
  [[nodiscard]] const std::uint16_t* group_row(int row) const { return &groups_[index(row, 0)]; }

 private:
  struct HullPoint {
    double u;
    double f;
    std::uint16_t site;
  };

  [[nodiscard]] std::size_t index(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_) +
           static_cast<std::size_t>(col);
  }
  void set_window(std::span<const Site> sites, std::span<const double> free_range_m);
  void hull_of_row(double x_m);
  void fill_row(int row, std::span<const Site> sites);

  double resolution_m_ = 0.05;
  // The whole field of view, in cells: rows [low_x_, high_x_), columns [low_y_, high_y_).
  int low_x_ = 0, high_x_ = 0, low_y_ = 0, high_y_ = 0;
  bool window_of_groups_ = false;
  std::vector<Eigen::Vector2d> directions_;  // of the beams
  std::vector<std::uint16_t> beam_of_cell_;  ///< beam count if no beam crosses the cell
  // The window of this scan.
  int first_x_ = 0, first_y_ = 0, rows_ = 0, cols_ = 0;
  std::vector<std::uint16_t> sites_, groups_;
  // Work space: sites by y; squared free range per beam and a zero for "no beam".
  std::vector<std::uint16_t> order_;
  std::vector<Eigen::Vector2d> sorted_;
  std::vector<double> free_sq_;
  std::vector<HullPoint> hull_;
};

}  // namespace topogeo::voronoi
