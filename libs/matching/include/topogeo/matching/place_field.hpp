// Whole map prepared for the search of places: nearness of each point to a surface, and the cells
// that a scan may come from (docs/algorithms.md, "Localization in a finished map (own)").
//
// A search tries every cell in 72 headings. Headings are independent of each other, so a search is
// divided into tasks of a few headings; from the best cells of each task, poses climb in a finer
// grid. Any machine that has the field can work on them: it travels as pieces in the form of local
// maps, which workers request, check and keep by their content like all others. The division does
// not depend on the number of workers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

// Nearness of every place in a finished map to a surface, in two grids: a coarse one to find the
// few places that a scan may come from, and a fine one to distinguish them.
//
// The kernels are integers up to 255, so that their sums are the same on every machine and many are
// added at once.

/// A grid of kernel values with a margin of zeros.
class KernelGrid {
 public:
  KernelGrid() = default;
  /// Points in the map frame, metres. Cells become larger than `cell_m` if the grid would have more
  /// than 2^24 of them. The grid extends `margin_m` beyond the points.
  KernelGrid(std::span<const Eigen::Vector2d> points_m, double cell_m, double width_m,
             double margin_m);

  [[nodiscard]] double cell_m() const { return cell_m_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  /// May lie outside the grid.
  [[nodiscard]] int column(double x_m) const {
    return floor_to_int((x_m - origin_m_.x()) / cell_m_);
  }
  [[nodiscard]] int row(double y_m) const { return floor_to_int((y_m - origin_m_.y()) / cell_m_); }
  [[nodiscard]] Eigen::Vector2d centre_m(int column, int row) const {
    return origin_m_ + Eigen::Vector2d(column + 0.5, row + 0.5) * cell_m_;
  }
  /// 255 at a point, falling to 0 at the width and beyond; 0 outside the grid.
  [[nodiscard]] int at(double x_m, double y_m) const {
    const double column = (x_m - origin_m_.x()) / cell_m_;
    const double row = (y_m - origin_m_.y()) / cell_m_;
    if (!(column >= 0.0 && row >= 0.0 && column < columns_ && row < rows_)) return 0;
    return cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
  }
  [[nodiscard]] const std::uint8_t* row_data(int row) const {
    return cells_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
  }

 private:
  static int floor_to_int(double value);

  Eigen::Vector2d origin_m_ = Eigen::Vector2d::Zero();
  double cell_m_ = 1.0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint8_t> cells_;
};

/// Mean kernel value of points at a pose, in [0, 1].
double mean_kernel(const KernelGrid& grid, std::span<const Eigen::Vector2d> points_m,
                   const geometry::Pose2& T_map_robot);

/// Climbs from a pose to the largest mean kernel value nearby: steps of 0.12 m and 3 degrees,
/// halved three times.
struct Climbed {
  geometry::Pose2 T_map_robot;
  double value = 0.0;  ///< mean_kernel
};
Climbed climb(const KernelGrid& grid, std::span<const Eigen::Vector2d> points_m,
              const geometry::Pose2& T_start);

class PlaceField {
 public:
  static constexpr std::uint32_t kHeadings = 72;    ///< 5 degrees apart
  static constexpr std::size_t kPoints = 128;       ///< limit per question; half of them search
  static constexpr std::size_t kTaskPoses = 38;     ///< limit of climbing poses per task
  static constexpr double kFineWidth_m = 0.30;      ///< of fine(): spans a cell of grid()
  static constexpr std::size_t kMostPieces = 1024;  ///< a larger field is not sent
  static constexpr std::uint32_t kFirstPiece = 0x80000000U;  ///< first id of pieces; no stop has it

  /// `walls`: points in the map frame, 5 cm apart. Scans come from up to `margin_m` beyond them.
  PlaceField(std::vector<topomap::ScanPoint> walls, double margin_m);
  /// Restores a field from its pieces, in order. Throws std::invalid_argument for invalid pieces.
  PlaceField(std::span<const std::shared_ptr<const topomap::LocalMap>> pieces,
             const PlaceQuestion& question);

  /// Sets the cells of grid() from which a scan may come, a byte for each; makes the pieces.
  void set_free(std::span<const std::uint8_t> free);

  [[nodiscard]] const KernelGrid& grid() const { return grid_; }
  [[nodiscard]] const std::vector<std::shared_ptr<const topomap::LocalMap>>& pieces() const {
    return pieces_;
  }
  /// Hash of everything that an answer depends on.
  [[nodiscard]] std::uint64_t hash() const { return hash_; }
  /// Approximate memory without the pieces.
  [[nodiscard]] std::size_t bytes() const;

  /// Grid in which poses climb, with cells of 5 cm.
  [[nodiscard]] const KernelGrid& fine() const { return fine_; }

  /// The questions that together search all headings for points in the robot frame; uses at most
  /// kPoints of them.
  [[nodiscard]] std::vector<std::shared_ptr<const PlaceQuestion>> questions(
      std::span<const Eigen::Vector2d> points_m) const;
  /// Climbs from the best cells of a question, no two of which touch, each in its best heading.
  /// Returns the final poses with their mean kernel value, that of the best cell first. Throws
  /// std::invalid_argument for a question about another field or about headings that do not exist.
  [[nodiscard]] std::vector<MatchSolution> answer(const PlaceQuestion& question) const;

  /// Returns the first fault of an answer as text; empty if its poses are possible results of a
  /// climb and their values are right to the last bit. Only a second answer shows that there is no
  /// better place.
  [[nodiscard]] std::string verify(const PlaceQuestion& question,
                                   std::span<const MatchSolution> places) const;

 private:
  /// Adjacent cells of one row.
  struct Run {
    int row = 0;
    int first_column = 0;
    int cells = 0;
    std::size_t first_seed = 0;  ///< total cells of the previous runs
  };
  struct Offset {
    int column = 0;
    int row = 0;
  };

  /// A free cell with the score of the points when the robot is there.
  struct Seed {
    std::uint16_t score = 0;
    std::uint16_t heading = 0;
    std::uint32_t cell = 0;  ///< index over all runs
  };
  [[nodiscard]] static bool comes_before(const Seed& a, const Seed& b);

  void add_run(int row, int first_column, int cells);
  void make_pieces();
  void check(const PlaceQuestion& question) const;
  [[nodiscard]] const Run& run_of(std::uint32_t cell) const;
  [[nodiscard]] geometry::Pose2 pose_of(const Seed& seed) const;
  /// The best heading of each cell, unordered.
  [[nodiscard]] std::vector<Seed> scored(const PlaceQuestion& question) const;
  /// Start poses of the climbs.
  [[nodiscard]] std::vector<geometry::Pose2> starts(const PlaceQuestion& question) const;
  [[nodiscard]] bool near_free_cell(const Eigen::Vector2d& p_m) const;
  [[nodiscard]] std::vector<Offset> offsets(const PlaceQuestion& question,
                                            std::uint32_t heading) const;
  [[nodiscard]] bool inside(const Run& run, const Offset& offset) const;

  std::vector<topomap::ScanPoint> walls_;
  double margin_m_;
  KernelGrid grid_;
  KernelGrid fine_;
  std::vector<Run> runs_;
  std::size_t cells_ = 0;
  std::vector<std::shared_ptr<const topomap::LocalMap>> pieces_;
  std::vector<std::uint64_t> piece_hashes_;
  std::uint64_t hash_ = 0;
};

}  // namespace topogeo::localization
