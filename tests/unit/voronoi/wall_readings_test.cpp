// Successive readings of one wall (on_wall_m), and the sites added between them (site_spacing_m).
// Beams of half a degree: at grazing incidence the readings of a wall 1 m beside
// the laser are 0.55 m apart at 8 m, more than the threshold of 4.7.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/voronoi/local_voronoi.hpp"

#include "test_world.hpp"

namespace topogeo::voronoi {
namespace {

using test_world::scan_of;
using test_world::World;

VoronoiConfig only_splitting(double on_wall_m) {
  VoronoiConfig config;
  config.range_limit_m = 12.0;
  config.discontinuity_m = 0.5;
  config.on_wall_m = on_wall_m;
  config.join_contiguous = false;
  config.join_alternate = false;
  config.drop_small = false;
  config.join_hidden_zones = false;
  return config;
}

std::vector<std::uint32_t> group_sizes(const scan::Scan& scan, const VoronoiConfig& config) {
  BeamDirections beams;
  beams.update(scan);
  GeneratorGroups groups;
  make_generator_groups(scan, beams, config, groups);
  std::vector<std::uint32_t> sizes;
  for (const PointRun& run : groups.groups) sizes.push_back(run.size());
  return sizes;
}

/// Number of groups of a world, whose mirror image must have the same groups in reverse.
std::size_t group_count(const World& world, const VoronoiConfig& config) {
  World mirror = world;
  for (test_world::Segment& wall : mirror) {
    wall.y0 = -wall.y0;
    wall.y1 = -wall.y1;
  }
  const auto sizes = group_sizes(scan_of(world), config);
  auto mirrored = group_sizes(scan_of(mirror), config);
  std::ranges::reverse(mirrored);
  EXPECT_EQ(sizes, mirrored);
  return sizes.size();
}

TEST(WallReadings, AWallSeenAtGrazingIncidenceStaysOneGroup) {
  const World wall{{-3, 1, 30, 1}};
  EXPECT_GT(group_count(wall, only_splitting(0.0)), 4U);
  EXPECT_EQ(group_count(wall, only_splitting(0.05)), 1U);
}

// y = 3   ------------------------
// y = 1   -------  door  ---------     from x = 5 to x = 6
//         R>
TEST(WallReadings, ADoorInTheLineOfTheWallSplitsIt) {
  const World world{{-3, 1, 5, 1}, {6, 1, 30, 1}, {-30, 3, 30, 3}};
  const auto scan = scan_of(world);
  const auto in_the_door = std::ranges::count_if(
      scan.ranges_m, [](float range_m) { return range_m > 15.0F && range_m < 19.0F; });
  ASSERT_GE(in_the_door, 3);  // beams through the door
  EXPECT_EQ(group_count(world, only_splitting(0.05)), 2U);
  VoronoiConfig far = only_splitting(0.05);
  far.range_limit_m = 20.0;  // now the wall behind the door also has readings
  EXPECT_EQ(group_count(world, far), 3U);
}

// The next reading on the second wall is 1.2 m on, about twice the spacing of the two before it:
// only its offset of 0.08 m from their line separates the walls.
TEST(WallReadings, ParallelWallsThatAreOffsetAreTwoGroups) {
  const World world{{-3, 1, 8, 1}, {8, 1.08, 30, 1.08}};
  EXPECT_EQ(group_count(world, only_splitting(0.05)), 2U);
  EXPECT_EQ(group_count(world, only_splitting(0.1)), 1U);
}

// A wall 0.1 m beside the laser, one degree between beams: at 3, 2 and 1 degrees the readings are
// 1.91, 2.87 and 5.73 m away. The first two, 0.96 m apart, do not determine the wall 2.87 m on.
TEST(WallReadings, TwoReadingsDoNotSayWhereAWallGoesFarBeyondThem) {
  scan::Scan scan;
  scan.angle_step_rad = std::numbers::pi / 180.0;
  scan.angle_min_rad = scan.angle_step_rad;
  for (int degree = 1; degree <= 40; ++degree) {
    scan.ranges_m.push_back(static_cast<float>(0.1 / std::sin(degree * scan.angle_step_rad)));
  }
  EXPECT_EQ(group_sizes(scan, only_splitting(0.05)), (std::vector<std::uint32_t>{1, 39}));
}

/// Largest distance of successive sites of one group.
double widest_gap_m(std::span<const Site> sites) {
  double widest_m = 0.0;
  for (std::size_t i = 1; i < sites.size(); ++i) {
    if (sites[i].group != sites[i - 1].group) continue;
    widest_m = std::max(widest_m, (sites[i].position_m - sites[i - 1].position_m).norm());
  }
  return widest_m;
}

/// Largest distance of the branch points from the line y = 0.2, metres. Ignores those with x > 9,
/// where the nearest readings are the last ones on the walls, which are not opposite each other.
double farthest_off_axis_m(const LocalVoronoiDiagram& diagram) {
  double farthest_m = 0.0;
  for (const DiagramPoint& point : diagram.points) {
    if (point.position_m.x() > 9.0) continue;
    farthest_m = std::max(farthest_m, std::abs(point.position_m.y() - 0.2));
  }
  return farthest_m;
}

// The far wall only proves that the corridor is free.
TEST(SiteSpacing, SitesBetweenReadingsOfAWallKeepTheBranchOnTheAxis) {
  const World corridor{{-3, 1.2, 30, 1.2}, {-3, -0.8, 30, -0.8}, {30, -3, 30, 3}};
  VoronoiConfig config;
  config.range_limit_m = 10.0;
  config.on_wall_m = 0.05;
  config.site_spacing_m = 0.1;
  LocalVoronoi spaced(config);
  const LocalVoronoiDiagram with = spaced.compute(scan_of(corridor));
  ASSERT_EQ(with.groups.groups.size(), 2U);
  EXPECT_LE(widest_gap_m(spaced.sites()), 0.1 + 1e-9);
  EXPECT_LT(farthest_off_axis_m(with), 0.01);

  config.site_spacing_m = 0.0;
  LocalVoronoi readings_only(config);
  const LocalVoronoiDiagram without = readings_only.compute(scan_of(corridor));
  EXPECT_EQ(readings_only.sites().size(), without.groups.points.size());
  EXPECT_GT(widest_gap_m(readings_only.sites()), 0.5);
  EXPECT_GT(farthest_off_axis_m(without), 0.02);
}

// Two boards one metre ahead with a gap of 0.4 m are one group by 4.8, but have no wall between
// them.
TEST(SiteSpacing, NoSiteIsPutBetweenReadingsThatAreNotOfOneWall) {
  VoronoiConfig config;
  config.site_spacing_m = 0.05;
  config.join_contiguous = true;
  config.contiguous_m = 0.55;
  LocalVoronoi voronoi(config);
  const auto diagram = voronoi.compute(scan_of({{1, -4, 1, -0.2}, {1, 0.2, 1, 4}}));
  ASSERT_TRUE(diagram.is_virtual);  // one group, followed by the virtual one
  EXPECT_GT(voronoi.sites().size(), diagram.groups.points.size());
  for (const Site& site : voronoi.sites()) {
    EXPECT_TRUE(site.group != 0 || std::abs(site.position_m.y()) > 0.2 - 1e-6);
  }
}

// A room with 80 m of wall: the configured spacing would give more sites than the grid can number.
TEST(WallReadings, SitesAreFartherApartWhereThereWouldBeTooMany) {
  const test_world::World room{
      {-9, -9, 9, -9}, {9, -9, 9, 9}, {9, 9, -9, 9}, {-9, 9, -9, -9}, {3, -1, 3, 1}};
  VoronoiConfig config;
  config.range_limit_m = 20.0;
  config.site_spacing_m = 0.001;
  LocalVoronoi voronoi{config};
  voronoi.compute(test_world::scan_of(room, {}, {.beams = 2048, .field_of_view_deg = 360.0}));
  EXPECT_LT(voronoi.sites().size(), NearestSiteGrid::kNone);
  EXPECT_GT(voronoi.sites().size(), 20000U);
}

}  // namespace
}  // namespace topogeo::voronoi
