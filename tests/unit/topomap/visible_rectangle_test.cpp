#include "topogeo/topomap/visible_rectangle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

namespace topogeo::topomap {
namespace {

using geometry::Pose2;

constexpr double kHalfTurn_rad = std::numbers::pi;

void expect_view(const VisibleRectangle& view, double low_x, double low_y, double high_x,
                 double high_y) {
  EXPECT_NEAR(view.low_m.x(), low_x, 1e-12);
  EXPECT_NEAR(view.low_m.y(), low_y, 1e-12);
  EXPECT_NEAR(view.high_m.x(), high_x, 1e-12);
  EXPECT_NEAR(view.high_m.y(), high_y, 1e-12);
}

bool holds(const VisibleRectangle& view, const Eigen::Vector2d& point_m) {
  constexpr double kRounding = 1e-9;
  return (point_m.array() >= view.low_m.array() - kRounding).all() &&
         (point_m.array() <= view.high_m.array() + kRounding).all();
}

TEST(VisibleRectangle, IsTheRectangleOfRobotNodesBranchesAndScan) {
  LocalMap map;
  LocalNode node;
  node.position_m = {3.0, 1.0};
  map.nodes.push_back(node);
  node.kind = NodeKind::kVirtual;
  node.position_m = {50.0, 0.0};
  map.nodes.push_back(node);
  LocalBranch branch;
  branch.points = {{{1.0, -2.0}, 0.5}, {{4.0, 0.0}, 0.5}};
  map.branches.push_back(branch);
  branch.is_virtual = true;
  branch.points = {{{0.0, -50.0}, 0.5}, {{0.0, 50.0}, 0.5}};
  map.branches.push_back(branch);
  map.points.push_back({2.0F, 2.5F});
  expect_view(visible_rectangle(map), 0.0, -2.0, 4.0, 2.5);  // 0: the robot itself
}

TEST(VisibleRectangle, OfAnEmptyMapIsTheRobot) {
  expect_view(visible_rectangle({}), 0.0, 0.0, 0.0, 0.0);
}

TEST(VisibleRectangle, SeenFromElsewhereIsMovedAndTurned) {
  // 4 m forward and 1 m to both sides, for a robot that faces left at (10, 5).
  const VisibleRectangle view{{0.0, -1.0}, {4.0, 1.0}};
  expect_view(seen_from(view, {10.0, 5.0, kHalfTurn_rad / 2.0}, {0.0, 0.0, 0.0}), 9.0, 5.0, 11.0,
              9.0);
  expect_view(seen_from(view, {10.0, 5.0, kHalfTurn_rad / 2.0}, {0.5, 0.25, 0.0}), 8.5, 4.75, 11.5,
              9.25);
}

TEST(VisibleRectangle, SwingsOutBetweenTheExtremeHeadings) {
  // The corners of the rectangle at 3, 4 m are 5 m away; each of them may be ahead when the
  // heading is uncertain by up to half a turn to both sides.
  const VisibleRectangle view{{0.0, -4.0}, {3.0, 4.0}};
  expect_view(seen_from(view, {}, {0.0, 0.0, kHalfTurn_rad}), -5.0, -5.0, 5.0, 5.0);
  expect_view(seen_from(view, {}, {0.0, 0.0, 100.0}), -5.0, -5.0, 5.0, 5.0);
  // Uncertain by 60 degrees: the front corners, 53 degrees off, pass straight ahead; (0, 4) and (0,
  // -4) turn backward by 4 sin 60.
  const VisibleRectangle turned = seen_from(view, {}, {0.0, 0.0, kHalfTurn_rad / 3.0});
  EXPECT_NEAR(turned.high_m.x(), 5.0, 1e-12);
  EXPECT_NEAR(turned.low_m.x(), -4.0 * std::sqrt(0.75), 1e-12);
}

// The envelope covers the view from every pose of the search space.
TEST(VisibleRectangle, EnvelopeContainsEveryPoseOfTheSearchSpace) {
  support::Random random(3);
  for (int round = 0; round < 200; ++round) {
    VisibleRectangle view;
    view.low_m = {random.uniform(-3.0, 1.0), random.uniform(-8.0, 0.0)};
    view.high_m = view.low_m + Eigen::Vector2d(random.uniform(0.0, 8.0), random.uniform(0.0, 9.0));
    const Pose2 T_frame_robot{random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0),
                              random.uniform(-kHalfTurn_rad, kHalfTurn_rad)};
    const Eigen::Vector3d half(random.uniform(0.0, 3.0), random.uniform(0.0, 3.0),
                               random.uniform(0.0, 3.5));
    const VisibleRectangle seen = seen_from(view, T_frame_robot, half);
    for (int sample = 0; sample < 200; ++sample) {
      const Pose2 pose{T_frame_robot.x_m + random.uniform(-half.x(), half.x()),
                       T_frame_robot.y_m + random.uniform(-half.y(), half.y()),
                       T_frame_robot.theta_rad + random.uniform(-half.z(), half.z())};
      const Eigen::Vector2d point(random.uniform(view.low_m.x(), view.high_m.x()),
                                  random.uniform(view.low_m.y(), view.high_m.y()));
      ASSERT_TRUE(holds(seen, pose * point)) << "round " << round;
    }
  }
}

TEST(VisibleRectangle, EnvelopeIsNoLargerThanItMustBe) {
  support::Random random(4);
  for (int round = 0; round < 50; ++round) {
    const VisibleRectangle view{{random.uniform(-3.0, 0.0), random.uniform(-4.0, 0.0)},
                                {random.uniform(0.0, 6.0), random.uniform(0.0, 4.0)}};
    const double turn_rad = random.uniform(0.0, 2.0);
    const VisibleRectangle seen = seen_from(view, {}, {0.0, 0.0, turn_rad});
    double farthest_x_m = -100.0;
    for (int k = -500; k <= 500; ++k) {
      const Pose2 pose{0.0, 0.0, turn_rad * k / 500.0};
      for (const double x : {view.low_m.x(), view.high_m.x()}) {
        for (const double y : {view.low_m.y(), view.high_m.y()}) {
          farthest_x_m = std::max(farthest_x_m, (pose * Eigen::Vector2d(x, y)).x());
        }
      }
    }
    EXPECT_NEAR(seen.high_m.x(), farthest_x_m, 1e-3);
  }
}

TEST(VisibleRectangle, RefusesAHalfWidthThatIsNone) {
  EXPECT_THROW(seen_from({}, {}, {-0.1, 0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(seen_from({}, {}, {0.0, std::nan(""), 0.0}), std::invalid_argument);
}

TEST(VisibleRectangle, OverlapHasBorders) {
  const VisibleRectangle a{{0.0, 0.0}, {2.0, 2.0}};
  EXPECT_TRUE(overlap(a, {{1.0, 1.0}, {3.0, 3.0}}));
  EXPECT_TRUE(overlap(a, {{0.5, 0.5}, {1.0, 1.0}}));
  EXPECT_TRUE(overlap(a, {{2.0, 0.0}, {3.0, 1.0}}));
  EXPECT_FALSE(overlap(a, {{2.1, 0.0}, {3.0, 1.0}}));
  EXPECT_FALSE(overlap(a, {{0.0, -2.0}, {2.0, -0.1}}));
}

// Fig. 7.10: two maps 12 m apart, each 5 m deep, overlap only for an uncertain pose.
TEST(OverlapSet, GrowsWithTheUncertainty) {
  const VisibleRectangle view{{0.0, -2.0}, {5.0, 2.0}};
  const std::vector<VisibleRectangle> earlier{view, view};
  std::vector<PlacedView> places{{{12.0, 0.0, 0.0}, Eigen::Vector3d::Zero()},
                                 {{4.0, 1.0, 0.0}, Eigen::Vector3d::Zero()}};
  EXPECT_EQ(overlap_set(view, earlier, places), std::vector<std::uint32_t>{1});
  places[0].half_width = {7.5, 1.0, 0.1};
  EXPECT_EQ(overlap_set(view, earlier, places), (std::vector<std::uint32_t>{0, 1}));
  places.pop_back();
  EXPECT_THROW(overlap_set(view, earlier, places), std::invalid_argument);
}

// The thesis's example: MS_44 = {42, 43}; at 45 the robot turns round and sees 33 to 42 and 44.
TEST(NewlySeen, AreTheMapsOutsideOfTheLastSetAndTheLastMap) {
  const std::vector<std::uint32_t> before{42, 43};
  const std::vector<std::uint32_t> turned{33, 34, 35, 36, 37, 38, 39, 40, 41, 42, 44};
  EXPECT_EQ(newly_seen(turned, before, 44),
            (std::vector<std::uint32_t>{33, 34, 35, 36, 37, 38, 39, 40, 41}));
  EXPECT_TRUE(newly_seen(std::vector<std::uint32_t>{43, 44}, before, 44).empty());
  EXPECT_TRUE(newly_seen({}, before, 44).empty());
}

}  // namespace
}  // namespace topogeo::topomap
