#include "topogeo/voronoi/generator_groups.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "test_world.hpp"

namespace topogeo::voronoi {
namespace {

using test_world::scan_of;
using test_world::World;

/// Beams one degree apart, the first at `first_deg`.
scan::Scan scan_with(std::vector<float> ranges_m, double first_deg = -90.0) {
  scan::Scan scan;
  scan.angle_min_rad = first_deg * std::numbers::pi / 180.0;
  scan.angle_step_rad = std::numbers::pi / 180.0;
  scan.ranges_m = std::move(ranges_m);
  return scan;
}

VoronoiConfig nothing_on() {
  VoronoiConfig config;
  config.join_contiguous = false;
  config.join_alternate = false;
  config.drop_small = false;
  config.join_hidden_zones = false;
  return config;
}

std::vector<std::uint32_t> sizes(const GeneratorGroups& groups) {
  std::vector<std::uint32_t> result;
  for (const PointRun& run : groups.groups) result.push_back(run.size());
  return result;
}

GeneratorGroups groups_of(const scan::Scan& scan, const VoronoiConfig& config) {
  BeamDirections beams;
  beams.update(scan);
  GeneratorGroups groups;
  make_generator_groups(scan, beams, config, groups);
  return groups;
}

using Sizes = std::vector<std::uint32_t>;

TEST(GeneratorGroups, SplitWhereTheRangeJumpsOrABeamIsMissing) {
  const auto scan = scan_with({2, 2, 2.6F, 2.5F, 0, 2.5F, 20, 2.5F, 2.5F});
  EXPECT_EQ(sizes(groups_of(scan, nothing_on())), (Sizes{2, 2, 1, 2}));

  VoronoiConfig config = nothing_on();
  config.split_discontinuities = false;
  EXPECT_EQ(sizes(groups_of(scan, config)), (Sizes{4, 1, 2}));
}

TEST(GeneratorGroups, NotANumberAndInfinityAreNoReadings) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const auto scan = scan_with({2, nan, 2, infinity, 2, -1, 2});
  EXPECT_EQ(sizes(groups_of(scan, nothing_on())), (Sizes{1, 1, 1, 1}));
}

TEST(GeneratorGroups, ContiguousGroupsJoinWhenTheRobotDoesNotFitBetween) {
  // Two boards side by side with a gap, one metre ahead.
  const auto across = [](double gap_m) {
    return World{{1, -2, 1, -gap_m / 2}, {1, gap_m / 2, 1, 2}};
  };
  VoronoiConfig config = nothing_on();
  EXPECT_EQ(groups_of(scan_of(across(0.4)), config).groups.size(), 2U);
  config.join_contiguous = true;
  EXPECT_EQ(groups_of(scan_of(across(0.4)), config).groups.size(), 1U);
  EXPECT_EQ(groups_of(scan_of(across(0.7)), config).groups.size(), 2U);
}

TEST(GeneratorGroups, AlternateGroupsJoinAndTheOneBetweenIsDropped) {
  // A far wall is visible through a gap of 0.4 m.
  const World world{{1, -2, 1, -0.2}, {1, 0.2, 1, 2}, {4, -3, 4, 3}};
  VoronoiConfig config = nothing_on();
  const GeneratorGroups before = groups_of(scan_of(world), config);
  ASSERT_EQ(before.groups.size(), 3U);
  config.join_alternate = true;
  const GeneratorGroups after = groups_of(scan_of(world), config);
  ASSERT_EQ(after.groups.size(), 1U);
  EXPECT_EQ(after.points.size(), before.groups[0].size() + before.groups[2].size());
  config.alternate_m = 0.3;
  EXPECT_EQ(groups_of(scan_of(world), config).groups.size(), 3U);
}

TEST(GeneratorGroups, WhatStandsInFrontOfAWallIsDroppedOnlyAsInTheSource) {
  // A post 0.2 m wide hides a strip of 0.4 m of the wall.
  const World world{{2, -2, 2, 2}, {1, -0.1, 1, 0.1}};
  VoronoiConfig config = nothing_on();
  config.join_alternate = true;
  EXPECT_EQ(groups_of(scan_of(world), config).groups.size(), 3U);
  config.alternate_behind_only = false;
  EXPECT_EQ(groups_of(scan_of(world), config).groups.size(), 1U);
}

TEST(GeneratorGroups, SmallGroupsGoUpToAndIncludingTheThreshold) {
  const auto scan = scan_with({2, 4, 4, 6, 6, 6, 8, 8, 8, 8});
  VoronoiConfig config = nothing_on();
  config.drop_small = true;
  config.min_group_points = 2;
  const GeneratorGroups groups = groups_of(scan, config);
  EXPECT_EQ(sizes(groups), (Sizes{3, 4}));
  EXPECT_EQ(groups.points.front().beam, 3U);
}

// Two boards one metre ahead with a gap of 0.4 m. Through the gap there is only one stray reading,
// 0.73 m before the edges of the boards.
TEST(GeneratorGroups, WhatAStrayReadingKeptApartIsJoinedOnceItIsGone) {
  scan::Scan scan = scan_of({{1, -2, 1, -0.2}, {1, 0.2, 1, 2}});
  ASSERT_EQ(scan.ranges_m[180], scan::Scan::kNoReturn);
  scan.ranges_m[180] = 0.3F;
  VoronoiConfig config;
  config.join_again = false;
  EXPECT_EQ(groups_of(scan, config).groups.size(), 2U);
  config.join_again = true;
  const GeneratorGroups joined = groups_of(scan, config);
  ASSERT_EQ(joined.groups.size(), 1U);
  for (const GroupPoint& point : joined.points) EXPECT_GT(point.range_m, 0.9F);
  // Without the removal of small groups, the stray reading and the gap remain.
  config.drop_small = false;
  EXPECT_EQ(groups_of(scan, config).groups.size(), 3U);
}

// A wall at 4 m and two stray readings 0.19 m apart at 1 m: between them the wall is visible.
TEST(GeneratorGroups, StrayReadingsDoNotTakeAwayTheWallBehindThem) {
  std::vector<float> ranges_m(32, 4.0F);
  ranges_m[10] = ranges_m[21] = 1.0F;
  const auto scan = scan_with(ranges_m, -16.0);
  VoronoiConfig config;
  config.alternate_large_only = true;
  EXPECT_EQ(sizes(groups_of(scan, config)), (Sizes{30}));
  config.alternate_large_only = false;
  EXPECT_EQ(sizes(groups_of(scan, config)), (Sizes{10, 10}));
  // Three readings are not stray: readings 0.19 m apart are one object.
  for (const std::size_t beam : {8U, 9U, 22U, 23U}) ranges_m[beam] = 1.0F;
  config.alternate_large_only = true;
  EXPECT_EQ(sizes(groups_of(scan_with(ranges_m, -16.0), config)), (Sizes{8, 6, 8}));
}

TEST(GeneratorGroups, HiddenZonesJoinOutwardJumpsOnTheRightAndInwardJumpsOnTheLeft) {
  VoronoiConfig config = nothing_on();
  config.join_hidden_zones = true;
  const std::vector<float> outward{2, 2, 4, 4};
  const std::vector<float> inward{4, 4, 2, 2};
  EXPECT_EQ(groups_of(scan_with(outward, -60.0), config).groups.size(), 1U);
  EXPECT_EQ(groups_of(scan_with(inward, -60.0), config).groups.size(), 2U);
  EXPECT_EQ(groups_of(scan_with(outward, 60.0), config).groups.size(), 2U);
  EXPECT_EQ(groups_of(scan_with(inward, 60.0), config).groups.size(), 1U);
  // The same beams of a laser mounted facing left are on the right of the robot.
  config.forward_rad = std::numbers::pi / 2.0;
  EXPECT_EQ(groups_of(scan_with(outward, 60.0), config).groups.size(), 1U);
}

TEST(GeneratorGroups, AClosedScanHasNoBorderBehindTheRobot) {
  const World room{{-2, -2, 2, -2}, {2, -2, 2, 2}, {2, 2, -2, 2}, {-2, 2, -2, -2}};
  const auto scan = scan_of(room, {}, {.beams = 360, .field_of_view_deg = 360.0});
  EXPECT_EQ(groups_of(scan, nothing_on()).groups.size(), 1U);
  const auto open = scan_of(room, {}, {.beams = 300, .field_of_view_deg = 300.0});
  EXPECT_FALSE(groups_of(open, nothing_on()).closed);
}

TEST(GeneratorGroups, TheMirrorImageOfAScanHasTheMirrorImageOfItsGroups) {
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    scan::Scan scan = scan_of(test_world::random_world(seed));
    VoronoiConfig config;
    config.join_alternate = seed % 2 == 0;
    config.alternate_behind_only = seed % 4 == 0;
    config.join_hidden_zones = seed % 3 == 0;
    Sizes forward = sizes(groups_of(scan, config));
    std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
    Sizes mirrored = sizes(groups_of(scan, config));
    std::reverse(mirrored.begin(), mirrored.end());
    EXPECT_EQ(forward, mirrored) << "seed " << seed;
  }
}

TEST(GeneratorGroups, AnglesThatMakeNoSenseAreNamed) {
  BeamDirections beams;
  scan::Scan scan = scan_with({1, 1, 1});
  scan.angle_step_rad = 0.0;
  EXPECT_THROW(beams.update(scan), std::invalid_argument);
  scan.angle_step_rad = 0.99e-5;
  EXPECT_THROW(beams.update(scan), std::invalid_argument);
  scan.angle_step_rad = 1e-5;
  EXPECT_NO_THROW(beams.update(scan));
  scan.angle_step_rad = 4.0;
  EXPECT_THROW(beams.update(scan), std::invalid_argument);
  scan.angle_step_rad = 0.01;
  scan.angle_min_rad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(beams.update(scan), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::voronoi
