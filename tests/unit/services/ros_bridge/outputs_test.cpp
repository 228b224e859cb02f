#include "ros_bridge/outputs.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/messaging/message.hpp"

#include "ros_conversions/ros_messages.hpp"

namespace topogeo::ros_bridge {
namespace {

using testing::Each;
using testing::SizeIs;

constexpr double kPi = std::numbers::pi;

// REP 105: map -> odom composed with odom -> robot is the pose on the map.
TEST(RosOutputs, TheCorrectionTimesTheOdometryIsThePose) {
  const geometry::Pose2 T_map_robot{2.0, -1.0, 2.5};
  const geometry::Pose2 T_odom_robot{0.5, 3.0, -1.2};
  const geometry::Pose2 again = correction_of(T_map_robot, T_odom_robot) * T_odom_robot;
  EXPECT_NEAR(again.x_m, 2.0, 1e-12);
  EXPECT_NEAR(again.y_m, -1.0, 1e-12);
  EXPECT_NEAR(geometry::wrap_angle(again.theta_rad - 2.5), 0.0, 1e-12);
}

TEST(RosOutputs, APoseHasItsCovarianceInTheRowsOfRos) {
  service::LivePose pose;
  pose.stamp_ns = 1'500'000'000;
  pose.T_map_robot = {1.0, 2.0, kPi / 2.0};
  pose.covariance << 0.1, 0.2, 0.3, 0.2, 0.4, 0.5, 0.3, 0.5, 0.6;
  const ros::PoseWithCovarianceStamped out = to_ros(pose, "map");
  EXPECT_EQ(out.header_().stamp_().sec_(), 1);
  EXPECT_EQ(out.header_().stamp_().nanosec_(), 500'000'000U);
  const auto& covariance = out.pose_().covariance_();
  EXPECT_EQ(covariance[0], 0.1);
  EXPECT_EQ(covariance[1], 0.2);
  EXPECT_EQ(covariance[6], 0.2);
  EXPECT_EQ(covariance[7], 0.4);
  EXPECT_EQ(covariance[5], 0.3);
  EXPECT_EQ(covariance[30], 0.3);
  EXPECT_EQ(covariance[11], 0.5);
  EXPECT_EQ(covariance[31], 0.5);
  EXPECT_EQ(covariance[35], 0.6);
  EXPECT_GT(covariance[14], 0.0);
  EXPECT_NEAR(out.pose_().pose_().orientation_().z_(), std::sin(kPi / 4.0), 1e-12);
  EXPECT_NEAR(ros::planar(out.pose_().pose_())->theta_rad, kPi / 2.0, 1e-12);
}

TEST(RosOutputs, APathLooksWhereItGoesAndInTheEndAsTheGoalDemands) {
  msg::Route route;
  route.status(msg::kRouteFound);
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, std::pair{1.0, 0.0}, std::pair{1.0, 2.0}}) {
    msg::BranchPoint point;
    point.x_m(x);
    point.y_m(y);
    route.points().push_back(point);
  }
  route.has_heading(true);
  route.heading_rad(-1.0);
  const ros::Path path = to_path(route, "map");
  ASSERT_THAT(path.poses_(), SizeIs(3));
  EXPECT_NEAR(ros::planar(path.poses_()[0].pose_())->theta_rad, 0.0, 1e-12);
  EXPECT_NEAR(ros::planar(path.poses_()[1].pose_())->theta_rad, kPi / 2.0, 1e-12);
  EXPECT_NEAR(ros::planar(path.poses_()[2].pose_())->theta_rad, -1.0, 1e-12);
  route.status(msg::kRouteNoPose);
  EXPECT_THAT(to_path(route, "map").poses_(), SizeIs(0));
}

TEST(RosOutputs, ARayWithoutAnEchoIsInfinite) {
  msg::Scan scan;
  scan.angle_min_rad(-1.0);
  scan.angle_step_rad(0.5);
  scan.ranges_m({1.0F, 0.0F, 2.0F});
  const ros::LaserScan out = to_ros(scan, "laser", 30.0F);
  EXPECT_EQ(out.ranges_()[0], 1.0F);
  EXPECT_EQ(out.ranges_()[1], std::numeric_limits<float>::infinity());
  EXPECT_FLOAT_EQ(out.angle_max_(), 0.0F);
}

TEST(RosOutputs, TheGraphBeginsWithAnOrderToDeleteAll) {
  topomap::GlobalMap map;
  map.nodes.push_back({.id = 4, .position_m = {1.0, 2.0}});
  map.nodes.push_back({.id = 7, .position_m = {3.0, 2.0}});
  topomap::MapBranch branch;
  branch.id = 1;
  branch.node_a = 4;
  branch.node_b = 7;
  branch.points = {{{1.0, 2.0}, 0.5}, {{3.0, 2.0}, 0.5}};
  map.branches.push_back(branch);
  const ros::MarkerArray array = graph_markers(map, "map", 0);
  ASSERT_THAT(array.markers_(), SizeIs(4));
  EXPECT_EQ(array.markers_()[0].action_(), 3);
  EXPECT_EQ(array.markers_()[1].id_(), 4);
  EXPECT_THAT(array.markers_()[3].points_(), SizeIs(2));
  for (const ros::Marker& marker : array.markers_()) {
    EXPECT_EQ(marker.pose_().orientation_().w_(), 1.0);
    EXPECT_EQ(marker.color_().a_(), marker.action_() == 0 ? 1.0F : 0.0F);
  }
}

TEST(RosOutputs, AServiceThatWaitsIsAWarning) {
  msg::ServiceStatus status;
  messaging::set_service(status, "planner", "1");
  status.state(msg::kServiceRunning);
  EXPECT_EQ(to_ros(status).level_(), 0);
  EXPECT_EQ(to_ros(status).name_(), "topogeo: planner");
  status.waits_for("a map");
  EXPECT_EQ(to_ros(status).level_(), 1);
  status.state(msg::kServiceFailed);
  EXPECT_EQ(to_ros(status).level_(), 2);
}

/// A grid of 70 x 65 cells, four tiles of 64 x 64; the first one is drawn.
class GridMirrorTest : public testing::Test {
 protected:
  static msg::GridTile tile(std::uint32_t number, std::uint64_t version, std::uint8_t state) {
    msg::GridTile tile;
    tile.tile(number);
    tile.version(version);
    tile.states().assign(msg::kTileArea, state);
    tile.zones().assign(msg::kTileArea, number == 0 ? 0 : msg::kNoZone);
    return tile;
  }
  static messaging::Handle handle(std::uint8_t number) {
    messaging::Handle handle;
    handle.bytes[0] = number;
    return handle;
  }
  static msg::HybridMap summary(std::uint64_t version, const std::vector<std::uint64_t>& tiles) {
    msg::HybridMap map;
    map.version(version);
    map.columns(70);
    map.rows(65);
    map.resolution_m(0.1);
    map.T_map_grid().x_m(-1.0);
    map.tile_versions() = {tiles.begin(), tiles.end()};
    msg::HybridZone zone;
    zone.name("hall");
    map.zones().push_back(zone);
    return map;
  }
  void fill() {
    for (std::uint8_t i = 0; i < 4; ++i) mirror_.put(tile(i, 1, i == 3 ? 1 : 0), handle(i));
    mirror_.put(summary(1, {1, 1, 1, 1}));
  }

  GridMirror mirror_;
};

TEST_F(GridMirrorTest, GivesTheWholeMapOnceEveryTileIsThere) {
  mirror_.put(summary(1, {1, 1, 1, 1}));
  for (std::uint8_t i = 0; i < 3; ++i) mirror_.put(tile(i, 1, 0), handle(i));
  EXPECT_FALSE(mirror_.take());
  mirror_.put(tile(3, 1, 1), handle(3));
  const auto change = mirror_.take();
  ASSERT_TRUE(change);
  EXPECT_TRUE(change->whole);
  EXPECT_FALSE(mirror_.take());
  const ros::OccupancyGrid grid = mirror_.grid("map", 0);
  ASSERT_EQ(grid.data_().size(), 70U * 65U);
  EXPECT_EQ(grid.data_()[0], 0);
  EXPECT_EQ(grid.data_()[64U * 70U + 63U], 0);
  EXPECT_EQ(grid.data_()[64U * 70U + 64U], 100);  // the one row and six columns of tile 3
  EXPECT_EQ(grid.info_().origin_().position_().x_(), -1.0);
}

TEST_F(GridMirrorTest, GivesTheRectangleThatHasChanged) {
  fill();
  ASSERT_TRUE(mirror_.take());
  mirror_.put(tile(1, 2, 2), handle(1));
  mirror_.put(summary(2, {1, 2, 1, 1}));
  const auto change = mirror_.take();
  ASSERT_TRUE(change);
  EXPECT_FALSE(change->whole);
  const ros::OccupancyGridUpdate update = mirror_.update(*change, "map", 0);
  EXPECT_EQ(update.x_(), 64);
  EXPECT_EQ(update.y_(), 0);
  EXPECT_EQ(update.width_(), 6U);
  EXPECT_EQ(update.height_(), 64U);
  EXPECT_THAT(update.data_(), SizeIs(6 * 64));
  EXPECT_THAT(update.data_(), Each(-1));
  EXPECT_EQ(mirror_.grid("map", 0).data_()[64], -1);
}

TEST_F(GridMirrorTest, AnotherSizeIsAnotherWholeMap) {
  fill();
  ASSERT_TRUE(mirror_.take());
  msg::HybridMap grown = summary(2, {1, 1});
  grown.columns(128);
  grown.rows(64);
  mirror_.put(grown);
  const auto change = mirror_.take();
  ASSERT_TRUE(change);
  EXPECT_TRUE(change->whole);
  EXPECT_EQ(mirror_.grid("map", 0).info_().width_(), 128U);
}

TEST_F(GridMirrorTest, NamesAZoneInItsMiddle) {
  fill();
  ASSERT_TRUE(mirror_.take());
  const auto middles = mirror_.zone_middles();
  ASSERT_EQ(middles.size(), 1U);
  ASSERT_TRUE(middles[0]);
  EXPECT_NEAR(middles[0]->x_m(), -1.0 + 3.2, 0.06);
  EXPECT_NEAR(middles[0]->y_m(), 3.2, 0.06);
  const ros::MarkerArray array = room_markers(mirror_, "map", 0);
  ASSERT_THAT(array.markers_(), SizeIs(2));
  EXPECT_EQ(array.markers_()[1].text_(), "hall");
}

TEST_F(GridMirrorTest, RefusesWhatContradictsItself) {
  msg::GridTile small = tile(0, 1, 0);
  small.states().resize(3);
  EXPECT_THROW(mirror_.put(small, handle(0)), std::invalid_argument);
  EXPECT_THROW(mirror_.put(summary(1, {1})), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::ros_bridge
