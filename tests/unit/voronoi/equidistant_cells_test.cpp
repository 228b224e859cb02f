// The Thesis's own rule by brute force, the reference for the cracks: every cell whose distances
// to its nearest groups differ by less than 2 E_max (4.18-4.22) belongs to the diagram, cells with
// the same base groups to one branch or node (4.23, 4.24).
//
// The two differ in wedges. Behind a gap between two groups, distances to both grow almost alike:
// whole areas pass the rule. When the line of equal distance itself is hidden, or runs along the
// edge of a shadow, all visible cells of such an area are nearer to the same group, and there is
// no branch. Therefore only cells where the two groups meet count: cells with a neighbour that is
// nearer to the other group.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/voronoi/distance_error.hpp"
#include "topogeo/voronoi/local_voronoi.hpp"

#include "recorded_logs.hpp"
#include "test_world.hpp"

namespace topogeo::voronoi {
namespace {

using BaseGroups = std::vector<std::uint16_t>;

struct Cell {
  BaseGroups groups;  ///< CB; empty when the cell is invisible or belongs to one group
  std::uint16_t nearest = NearestSiteGrid::kNone;
};

/// The cells of a diagram by the Thesis's rule.
class EquidistantCells {
 public:
  explicit EquidistantCells(const LocalVoronoi& voronoi, std::size_t groups)
      : grid_(voronoi.grid()), cells_(static_cast<std::size_t>(grid_.rows() * grid_.cols())) {
    const double largest_m = 2.0 * largest_distance_error_m(grid_.resolution_m());
    std::vector<double> distances_m(groups);
    for (int row = 0; row < grid_.rows(); ++row) {
      for (int col = 0; col < grid_.cols(); ++col) {
        if (grid_.group(row, col) == NearestSiteGrid::kNone) continue;
        measure(voronoi.sites(), grid_.centre(row, col), distances_m);
        const auto nearest = std::ranges::min_element(distances_m);
        Cell& cell = at(row, col);
        cell.nearest = static_cast<std::uint16_t>(nearest - distances_m.begin());
        for (std::size_t g = 0; g < groups; ++g) {
          if (distances_m[g] - *nearest < largest_m) {
            cell.groups.push_back(static_cast<std::uint16_t>(g));
          }
        }
        if (cell.groups.size() < 2) cell.groups.clear();
      }
    }
  }

  [[nodiscard]] Cell& at(int row, int col) {
    return cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid_.cols()) +
                  static_cast<std::size_t>(col)];
  }
  [[nodiscard]] bool inside(int row, int col) const {
    return row >= 0 && col >= 0 && row < grid_.rows() && col < grid_.cols();
  }
  /// Row and column of the cell that contains a point.
  [[nodiscard]] std::array<int, 2> cell_of(const Eigen::Vector2d& at_m) const {
    const Eigen::Vector2d from_first = (at_m - grid_.centre(0, 0)) / grid_.resolution_m();
    return {static_cast<int>(std::lround(from_first.x())),
            static_cast<int>(std::lround(from_first.y()))};
  }

 private:
  static void measure(std::span<const Site> sites, const Eigen::Vector2d& at_m,
                      std::vector<double>& distances_m) {
    std::ranges::fill(distances_m, std::numeric_limits<double>::infinity());
    for (const Site& site : sites) {
      double& nearest_sq = distances_m[site.group];
      nearest_sq = std::min(nearest_sq, (site.position_m - at_m).squaredNorm());
    }
    for (double& distance : distances_m) distance = std::sqrt(distance);
  }

  const NearestSiteGrid& grid_;
  std::vector<Cell> cells_;
};

constexpr std::array<std::array<int, 2>, 4> kBeside{{{0, 1}, {1, 0}, {0, -1}, {-1, 0}}};

/// Cells of one branch that are connected by their sides.
struct Patch {
  BaseGroups groups;
  std::vector<std::array<int, 2>> cells;

  /// The longer side of its bounding box, in cells.
  [[nodiscard]] int length() const {
    std::array<int, 4> box{cells[0][0], cells[0][0], cells[0][1], cells[0][1]};
    for (const auto& [row, col] : cells) {
      box = {std::min(box[0], row), std::max(box[1], row), std::min(box[2], col),
             std::max(box[3], col)};
    }
    return std::max(box[1] - box[0], box[3] - box[2]) + 1;
  }
};

/// True if the two base groups of a cell meet at one of its sides.
bool groups_meet(EquidistantCells& cells, int row, int col) {
  const Cell& cell = cells.at(row, col);
  return std::ranges::any_of(kBeside, [&](const std::array<int, 2>& step) {
    if (!cells.inside(row + step[0], col + step[1])) return false;
    const std::uint16_t other = cells.at(row + step[0], col + step[1]).nearest;
    return other != cell.nearest && std::ranges::find(cell.groups, other) != cell.groups.end();
  });
}

/// Removes all patches of branch cells from the grid, or only of those where their groups meet.
std::vector<Patch> take_patches(EquidistantCells cells, int rows, int cols, bool only_meeting) {
  std::vector<Patch> patches;
  if (only_meeting) {
    for (int row = 0; row < rows; ++row) {
      for (int col = 0; col < cols; ++col) {
        if (!groups_meet(cells, row, col)) cells.at(row, col).groups.clear();
      }
    }
  }
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      if (cells.at(row, col).groups.size() != 2) continue;
      Patch patch{cells.at(row, col).groups, {{row, col}}};
      cells.at(row, col).groups.clear();
      for (std::size_t i = 0; i < patch.cells.size(); ++i) {
        const auto [r, c] = patch.cells[i];
        for (const auto& [dr, dc] : kBeside) {
          if (!cells.inside(r + dr, c + dc)) continue;
          Cell& next = cells.at(r + dr, c + dc);
          if (next.groups != patch.groups) continue;
          next.groups.clear();
          patch.cells.push_back({r + dr, c + dc});
        }
      }
      patches.push_back(std::move(patch));
    }
  }
  return patches;
}

struct Tally {
  int points = 0;   ///< branch points, all inside their cells
  int patches = 0;  ///< longer than four cells where their groups meet, completely followed
  int areas = 0;    ///< longer than four cells, even where their groups do not meet
};

/// Compares the diagram of one scan with the rule, in both directions.
void expect_agreement(const scan::Scan& scan, const VoronoiConfig& config, const std::string& name,
                      Tally& tally) {
  LocalVoronoi voronoi{config};
  const LocalVoronoiDiagram diagram = voronoi.compute(scan);
  if (diagram.is_virtual) return;
  EquidistantCells cells(voronoi, diagram.groups.groups.size());
  std::map<BaseGroups, std::vector<std::array<int, 2>>> reached;
  for (const DiagramBranch& branch : diagram.branches) {
    const auto points = diagram.points_of(branch);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto [row, col] = cells.cell_of(points[i].position_m);
      reached[{branch.base_groups[0], branch.base_groups[1]}].push_back({row, col});
      // The ends may be a node merged from several corners.
      if (i == 0 || i + 1 == points.size()) continue;
      ASSERT_TRUE(cells.inside(row, col)) << name;
      const Cell& cell = cells.at(row, col);
      if (cell.nearest == NearestSiteGrid::kNone) continue;  // just beyond the border of the view
      EXPECT_TRUE(std::ranges::includes(cell.groups, branch.base_groups))
          << name << " at " << points[i].position_m.transpose();
      ++tally.points;
    }
  }
  const NearestSiteGrid& grid = voronoi.grid();
  for (const Patch& area : take_patches(cells, grid.rows(), grid.cols(), false)) {
    tally.areas += area.length() > 4 ? 1 : 0;
  }
  for (const Patch& patch : take_patches(cells, grid.rows(), grid.cols(), true)) {
    if (patch.length() <= 4) continue;
    const auto& at = reached[patch.groups];
    const bool whole = std::ranges::all_of(patch.cells, [&](const std::array<int, 2>& cell) {
      return std::ranges::any_of(at, [&](const std::array<int, 2>& point) {
        return std::abs(point[0] - cell[0]) <= 2 && std::abs(point[1] - cell[1]) <= 2;
      });
    });
    EXPECT_TRUE(whole) << name << ": groups " << patch.groups[0] << " and " << patch.groups[1]
                       << ", " << patch.cells.size() << " cells, " << patch.length() << " long at "
                       << grid.centre(patch.cells[0][0], patch.cells[0][1]).transpose();
    ++tally.patches;
  }
}

TEST(EquidistantCells, HoldTheBranchesAndHaveNoOthersOnRandomScenes) {
  VoronoiConfig config;
  config.range_limit_m = 6.0;
  config.min_branch_m = 0.0;  // the rule has no minimum length
  Tally tally;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    const test_world::Laser laser{.beams = seed % 2 == 0 ? 361U : 720U,
                                  .field_of_view_deg = seed % 2 == 0 ? 180.0 : 360.0};
    expect_agreement(test_world::scan_of(test_world::random_world(seed), {}, laser), config,
                     "seed " + std::to_string(seed), tally);
  }
  std::printf("%d branch points, %d patches of %d areas\n", tally.points, tally.patches,
              tally.areas);
  EXPECT_GT(tally.points, 3000);
  EXPECT_GT(tally.patches, 100);
}

TEST(EquidistantCells, HoldTheBranchesAndHaveNoOthersOnRecordedScans) {
  if (recorded_logs().empty()) GTEST_SKIP() << "no logs in ../shared/data or TOPOGEO_LOG_DIR";
  VoronoiConfig config;
  config.range_limit_m = 6.0;
  config.min_branch_m = 0.0;  // the rule has no minimum length
  Tally tally;
  for (const auto& path : recorded_logs()) {
    scan::CarmenLogReader reader(path);
    int number = 0;
    while (const auto scan = reader.next()) {
      if (number++ % 60 != 0) continue;
      expect_agreement(*scan, config,
                       path.filename().string() + " scan " + std::to_string(number - 1), tally);
    }
  }
  std::printf("%d branch points, %d patches of %d areas\n", tally.points, tally.patches,
              tally.areas);
  EXPECT_GT(tally.patches, 0);
}

}  // namespace
}  // namespace topogeo::voronoi
