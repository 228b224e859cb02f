#include "topogeo/voronoi/nearest_site_grid.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "topogeo/voronoi/local_voronoi.hpp"

#include "test_world.hpp"

namespace topogeo::voronoi {
namespace {

using test_world::Laser;

/// Brute-force twin: the distances of every visible cell to its nearest site and to the nearest
/// site of its group, and visibility from the scan itself.
void expect_equal_to_brute_force(const LocalVoronoi& voronoi, const scan::Scan& scan) {
  const NearestSiteGrid& grid = voronoi.grid();
  for (int row = 0; row < grid.rows(); ++row) {
    for (int col = 0; col < grid.cols(); ++col) {
      const Eigen::Vector2d centre = grid.centre(row, col);
      const double beam = std::remainder(std::atan2(centre.y(), centre.x()) - scan.angle_min_rad -
                                             M_PI + 0.5 * scan.angle_step_rad,
                                         2.0 * M_PI) +
                          M_PI;
      const auto index = static_cast<std::size_t>(beam / scan.angle_step_rad);
      const double free_m = index < scan.ranges_m.size() ? voronoi.free_range_m()[index] : 0.0;
      // Rounding may assign cells on the border to either side.
      const double in_beam = beam / scan.angle_step_rad - static_cast<double>(index);
      if (in_beam < 1e-6 || in_beam > 1.0 - 1e-6 || std::abs(centre.norm() - free_m) < 1e-9)
        continue;
      ASSERT_EQ(grid.site(row, col) != NearestSiteGrid::kNone, centre.norm() < free_m)
          << centre.transpose();
      if (grid.site(row, col) == NearestSiteGrid::kNone) continue;

      double nearest_m = std::numeric_limits<double>::infinity();
      for (const Site& site : voronoi.sites()) {
        nearest_m = std::min(nearest_m, (site.position_m - centre).norm());
      }
      const Site& site = voronoi.sites()[grid.site(row, col)];
      ASSERT_NEAR((site.position_m - centre).norm(), nearest_m, 1e-12) << centre.transpose();
      ASSERT_EQ(grid.group(row, col), site.group);
    }
  }
}

TEST(NearestSiteGrid, EqualsBruteForceOnRandomScenes) {
  const Laser lasers[] = {{361, 180.0, 50.0},
                          {181, 180.0, 6.0},
                          {541, 270.0, 50.0},
                          {360, 360.0, 50.0},
                          {90, 60.0, 50.0}};
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const scan::Scan scan = test_world::scan_of(test_world::random_world(seed),
                                                {0.013, -0.021, 0.1 * seed}, lasers[seed % 5]);
    VoronoiConfig config;
    config.resolution_m = seed % 2 == 0 ? 0.1 : 0.07;
    config.range_limit_m = seed % 3 == 0 ? 4.0 : 8.0;
    LocalVoronoi voronoi(config);
    voronoi.compute(scan);
    expect_equal_to_brute_force(voronoi, scan);
  }
}

TEST(NearestSiteGrid, SitesInOneColumnAndAtOnePlaceAreNoTrouble) {
  scan::Scan scan;
  scan.angle_min_rad = -1.5;
  scan.angle_step_rad = 0.1;
  scan.ranges_m.assign(31, 3.0F);
  BeamDirections beams;
  beams.update(scan);
  NearestSiteGrid grid;
  VoronoiConfig config;
  config.range_limit_m = 4.0;
  config.window_of_groups = true;
  grid.set_geometry(beams, config);
  const std::vector<double> free_range_m(31, 4.0);
  const std::vector<Site> sites{{{1.0, 0.5}, 0}, {{2.0, 0.5}, 1}, {{2.0, 0.5}, 2}, {{0.0, 0.5}, 3}};
  grid.compute(sites, free_range_m);
  ASSERT_GT(grid.rows(), 38);
  ASSERT_EQ(grid.cols(), 1);
  EXPECT_EQ(grid.group(39, 0), 1);  // x = 1.975: the first of two sites at the same place
  EXPECT_EQ(grid.group(22, 0), 0);  // x = 1.125
}

}  // namespace
}  // namespace topogeo::voronoi
