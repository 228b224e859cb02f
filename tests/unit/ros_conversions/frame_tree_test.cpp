#include "topogeo/ros_conversions/frame_tree.hpp"

#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "topogeo/ros_conversions/geometry.hpp"

#include "ros_messages.hpp"

namespace topogeo::ros {
namespace {

constexpr double kPi = std::numbers::pi;

geometry::Pose2 found(const FrameTree& tree, const std::string& from, const std::string& to) {
  const auto T_from_to = tree.find(from, to);
  return T_from_to ? planar_mounting(*T_from_to).T_robot_laser : geometry::Pose2{99.0, 99.0, 0.0};
}

TEST(FrameTree, JoinsFramesThroughTheirParents) {
  FrameTree tree;
  EXPECT_TRUE(tree.put("base_footprint", "base_link", at(0.0, 0.0, 0.0)));
  EXPECT_TRUE(tree.put("base_link", "mast", at(0.2, 0.0, kPi / 2.0)));
  EXPECT_TRUE(tree.put("mast", "laser", at(0.1, 0.0, 0.0)));
  EXPECT_EQ(found(tree, "base_footprint", "laser"), (geometry::Pose2{0.2, 0.1, 1.57080}));
  EXPECT_FALSE(tree.find("base_link", "camera"));
  EXPECT_FALSE(tree.put("base_link", "laser", at(0.0, 0.0, 0.0)));  // it has a parent
  EXPECT_EQ(found(tree, "base_footprint", "laser"), (geometry::Pose2{0.2, 0.1, 1.57080}));
  EXPECT_TRUE(tree.put("mast", "laser", at(0.3, 0.0, 0.0)));  // the last holds
  EXPECT_EQ(found(tree, "mast", "laser"), (geometry::Pose2{0.3, 0.0, 0.0}));
}

TEST(FrameTree, KeepsNoNameThatIsLong) {
  FrameTree tree;
  const std::string longest(kLongestFrameName, 'f');
  EXPECT_TRUE(tree.put("base_link", longest, at(0.0, 0.0, 0.0)));
  EXPECT_FALSE(tree.put("base_link", longest + "f", at(0.0, 0.0, 0.0)));
  EXPECT_FALSE(tree.put(longest + "f", "laser", at(0.0, 0.0, 0.0)));
  TFMessage message;
  message.transforms_() = {transform_of("base_link", longest + "f", {}, 0)};
  tree.add(message, true);
  EXPECT_EQ(tree.edges().size(), 1U);
}

TEST(FrameTree, ACircleEnds) {
  FrameTree tree;
  tree.put("a", "b", at(0.0, 0.0, 0.0));
  tree.put("b", "a", at(0.0, 0.0, 0.0));
  EXPECT_FALSE(tree.find("a", "c"));
}

// Recordings contain this: the base has two connections to odom, and names have slashes.
TEST(FrameTree, FindsTheShortestPathBetweenFramesOfTwoParents) {
  TFMessage fixed;
  fixed.transforms_() = {transform_of("/base_link", "plate", {1.0, 0.0, kPi / 2.0}, 0),
                         transform_of("plate", "laser", {2.0, 0.0, 0.0}, 0)};
  FrameTree tree;
  tree.add(fixed, true);
  TFMessage moving;
  moving.transforms_() = {transform_of("odom", "base_link", {5.0, 0.0, 0.0}, 0),
                          transform_of("odom", "base_footprint", {4.0, 0.0, 0.0}, 0)};
  tree.add(moving, false);
  EXPECT_EQ(found(tree, "base_footprint", "laser"), (geometry::Pose2{2.0, 2.0, 1.57080}));
  moving.transforms_() = {transform_of("odom", "base_link", {5.01, 0.0, 0.0}, 0)};
  tree.add(moving, false);  // the first one remains
  EXPECT_EQ(found(tree, "base_footprint", "laser"), (geometry::Pose2{2.0, 2.0, 1.57080}));
  EXPECT_FALSE(tree.edges()[2].moves);
  moving.transforms_() = {transform_of("odom", "base_link", {9.0, 0.0, 0.0}, 0)};
  tree.add(moving, false);
  EXPECT_TRUE(tree.edges()[2].moves);
  EXPECT_EQ(found(tree, "base_link", "laser"), (geometry::Pose2{1.0, 2.0, 1.57080}));
  EXPECT_FALSE(tree.find("base_footprint", "laser"));  // not on a path that moves
  EXPECT_FALSE(tree.find("base_link", "camera"));
  ASSERT_EQ(tree.edges().size(), 4U);
  EXPECT_EQ(tree.edges()[2].count, 3U);
}

TEST(FrameTree, TakesTheEdgesOfAnother) {
  FrameTree tree;
  tree.add("odom", "base_link", at(0.0, 0.0, 0.0), false);
  FrameTree other;
  other.add("base_link", "laser", at(0.2, 0.0, 0.0), true);
  for (const double x_m : {0.0, 1.0}) other.add("odom", "base_link", at(x_m, 0.0, 0.0), false);
  tree.add(other);
  EXPECT_EQ(found(tree, "base_link", "laser"), (geometry::Pose2{0.2, 0.0, 0.0}));
  EXPECT_EQ(tree.edges().front().count, 3U);
  EXPECT_TRUE(tree.edges().front().moves);
}

TEST(LaserMounting, IsTheSameWhileItJitters) {
  const Eigen::Isometry3d mounting = at(0.2, 0.1, 1.0);
  EXPECT_TRUE(is_same_mounting(mounting, at(0.23, 0.12, 1.04)));
  EXPECT_TRUE(is_same_mounting(mounting, at(0.2, 0.1, 1.0, 0.1)));  // leans
  EXPECT_FALSE(is_same_mounting(mounting, at(0.26, 0.1, 1.0)));
  EXPECT_FALSE(is_same_mounting(mounting, at(0.2, 0.1, 1.06)));
  EXPECT_FALSE(is_same_mounting(mounting, at(0.2, 0.1, 1.0, 0.15)));
  EXPECT_FALSE(is_same_mounting(mounting, at(0.2, 0.1, 1.0, kPi)));
}

TEST(FrameTree, PassesOverWhatIsNoTransform) {
  TFMessage message;
  message.transforms_() = {transform_of("a", "b", {}, 0), transform_of("a", "c", {}, 0)};
  message.transforms_()[0].transform_().rotation_().w_(0.0);  // a quaternion of zero length
  message.transforms_()[1].transform_().translation_().z_(std::numeric_limits<double>::quiet_NaN());
  FrameTree tree;
  tree.add(message, true);
  EXPECT_TRUE(tree.edges().empty());
}

TEST(LaserMounting, IsSeenFromAbove) {
  EXPECT_FALSE(planar_mounting(at(0.1, 0.0, 0.0)).upside_down);
  const LaserMounting turned = planar_mounting(at(0.12344, 0.0, 0.5, kPi));
  EXPECT_TRUE(turned.upside_down);
  EXPECT_EQ(turned.T_robot_laser, (geometry::Pose2{0.1234, 0.0, 0.5}));
  EXPECT_NEAR(turned.tilt_rad, 0.0, 1e-9);
  EXPECT_NEAR(planar_mounting(at(0.1, 0.0, 0.3, 0.5)).tilt_rad, 0.5, 1e-9);
  EXPECT_LT(kLargestTilt_rad, 0.5);
}

}  // namespace
}  // namespace topogeo::ros
