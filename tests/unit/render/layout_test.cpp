#include "layout.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "legend_items.hpp"
#include "point_raster.hpp"
#include "sample_floor.hpp"

namespace topogeo::render {
namespace {

ScanOutline wall(double direction_rad, double length_m) {
  ScanOutline outline;
  for (double s = 0.0; s < length_m; s += 0.05) {
    outline.emplace_back(s * std::cos(direction_rad), s * std::sin(direction_rad));
  }
  return outline;
}

TEST(DominantWallDirection, FindsTheDirectionOfMostWallModuloARightAngle) {
  for (const double direction_rad : {0.0, 0.004, 0.3, 0.8, 1.2, 1.567}) {
    const double right_rad = direction_rad + std::numbers::pi / 2;
    const double found = dominant_wall_direction_rad(
        {wall(direction_rad, 5.0), wall(right_rad, 4.0), wall(direction_rad + 0.6, 6.0)});
    // The difference modulo 90 degrees.
    EXPECT_NEAR(std::sin(2.0 * (found - direction_rad)), 0.0, 0.01) << direction_rad;
    EXPECT_GE(found, 0.0);
    EXPECT_LT(found, std::numbers::pi / 2);
  }
}

TEST(DominantWallDirection, IsZeroWithoutWalls) {
  EXPECT_EQ(dominant_wall_direction_rad({}), 0.0);
  EXPECT_EQ(dominant_wall_direction_rad({ScanOutline{}, ScanOutline{{1.0, 2.0}}}), 0.0);
}

TEST(Layout, PutsTheLongSideAcrossAndKeepsTheAspect) {
  const SampleFloor floor = sample_floor();
  const MapPicture picture = floor.picture();
  const Layout layout = make_layout(picture, outlines_in_map(picture), {});
  EXPECT_EQ(layout.width_px, 1600U);
  EXPECT_GT(layout.map_width_px, layout.map_height_px);
  // Perpendicular walls of the map are horizontal and vertical in the picture, at one scale.
  const geometry::Pose2 T_map_floor{0.0, 0.0, 0.3};
  const Eigen::Vector2d origin = layout.to_px(T_map_floor * Eigen::Vector2d(0.0, 0.0));
  const Eigen::Vector2d along = layout.to_px(T_map_floor * Eigen::Vector2d(10.0, 0.0)) - origin;
  const Eigen::Vector2d across = layout.to_px(T_map_floor * Eigen::Vector2d(0.0, 10.0)) - origin;
  EXPECT_NEAR(along.x(), 10.0 * layout.scale_px_per_m, 1.0);
  EXPECT_NEAR(along.y(), 0.0, 1.0);
  EXPECT_NEAR(across.x(), 0.0, 1.0);
  EXPECT_NEAR(across.y(), -10.0 * layout.scale_px_per_m, 1.0);
}

TEST(Layout, TurnsATallMap) {
  std::vector<topomap::StampedPose> path{{0, 0, {0.0, 0.0, 0.0}}, {1, 0, {1.0, 30.0, 0.0}}};
  MapPicture picture;
  picture.corrected = path;
  const Layout layout = make_layout(picture, {}, {});
  EXPECT_GT(layout.map_width_px, 5.0 * layout.map_height_px);
}

TEST(Layout, IsNotBlownUpByLostOdometry) {
  const SampleFloor floor = sample_floor();
  std::vector<topomap::StampedPose> lost = floor.odometry;
  lost.back().pose.x_m = 1e6;
  MapPicture picture = floor.picture();
  picture.odometry = lost;
  const Layout layout = make_layout(picture, outlines_in_map(picture), {});
  EXPECT_LT(layout.max_m.x() - layout.min_m.x(), 60.0);
}

TEST(PointRaster, DrawsEachCellOnceAndJoinsNeighbours) {
  Layout layout;  // not rotated, corner at (0, 0)
  const std::vector<ScanOutline> outlines{{{0.05, 0.05}, {0.15, 0.05}, {0.06, 0.04}},
                                          {{0.25, 0.02}, {0.55, 0.05}, {0.05, 0.15}}};
  const auto runs = raster_runs(outlines, layout, 0.1);
  ASSERT_EQ(runs.size(), 3U);
  EXPECT_TRUE(runs[0].from_m.isApprox(Eigen::Vector2d(0.0, 0.05)));
  EXPECT_TRUE(runs[0].to_m.isApprox(Eigen::Vector2d(0.3, 0.05)));
  EXPECT_TRUE(runs[1].from_m.isApprox(Eigen::Vector2d(0.5, 0.05)));
  EXPECT_TRUE(runs[2].to_m.isApprox(Eigen::Vector2d(0.1, 0.15)));
  EXPECT_TRUE(raster_runs({}, layout, 0.1).empty());
}

TEST(ScaleBar, HasARoundLength) {
  EXPECT_EQ(round_length_m(1.0), 1.0);
  EXPECT_EQ(round_length_m(4.9), 2.0);
  EXPECT_EQ(round_length_m(7.0), 5.0);
  EXPECT_EQ(round_length_m(99.0), 50.0);
  EXPECT_NEAR(round_length_m(0.3), 0.2, 1e-12);
}

}  // namespace
}  // namespace topogeo::render
