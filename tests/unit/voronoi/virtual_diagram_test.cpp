// The line of a virtual diagram (4.2.1) in a dead end, which is one group: the line stops at
// readings and hides everything behind it.
#include <cmath>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "topogeo/voronoi/local_voronoi.hpp"

#include "test_world.hpp"

namespace topogeo::voronoi {
namespace {

using geometry::Pose2;
using test_world::scan_of;
using test_world::World;

// A dead end 1.6 m wide, open towards the robot's back.
//   -----------+
//     robot >  | x = 4
//   -----------+
const World kDeadEnd{{-6, 0.8, 4, 0.8}, {4, 0.8, 4, -0.8}, {4, -0.8, -6, -0.8}};

struct SeenDiagram {
  LocalVoronoiDiagram diagram;
  double line_y_m = 0.0;  ///< of the virtual group, which is the last one; laser frame
};

/// View of the robot `y_m` beside the axis, turned by `heading_rad`.
SeenDiagram seen_from(double y_m, double heading_rad) {
  LocalVoronoi voronoi{VoronoiConfig{}};
  SeenDiagram seen_diagram{voronoi.compute(scan_of(kDeadEnd, {0.0, y_m, heading_rad}))};
  EXPECT_TRUE(seen_diagram.diagram.is_virtual);
  EXPECT_EQ(seen_diagram.diagram.groups.groups.size(), 2U);
  EXPECT_FALSE(seen_diagram.diagram.branches.empty());
  const PointRun& line = seen_diagram.diagram.groups.groups.back();
  seen_diagram.line_y_m = seen_diagram.diagram.groups.points[line.begin].position_m.y();
  return seen_diagram;
}

TEST(VirtualDiagram, TheLineStopsAtReadings) {
  for (const double y_m : {-0.3, -0.1, 0.05, 0.3}) {
    for (const double heading_rad : {-0.3, -0.1, 0.0, 0.1, 0.3}) {
      SCOPED_TRACE(std::to_string(y_m) + " m, " + std::to_string(heading_rad) + " rad");
      const SeenDiagram seen_diagram = seen_from(y_m, heading_rad);
      const PointRun line = seen_diagram.diagram.groups.groups.back();
      ASSERT_GT(line.size(), 4U);
      for (std::uint32_t i = line.begin; i < line.end; ++i) {
        const Eigen::Vector2d& point_m = seen_diagram.diagram.groups.points[i].position_m;
        EXPECT_DOUBLE_EQ(point_m.y(), seen_diagram.line_y_m);
        // A point belongs to the nearest beam, a quarter of a degree off at most.
        const Eigen::Vector2d in_world_m = Pose2{0.0, y_m, heading_rad} * point_m;
        EXPECT_LT(in_world_m.x(), 4.02);
        EXPECT_LT(std::abs(in_world_m.y()), 0.82);
      }
    }
  }
}

// A stub 0.12 m long at x = 2 crosses the line, which would be visible again behind its shadow.
TEST(VirtualDiagram, TheLineDoesNotGoOnBehindAnObstacle) {
  World world = kDeadEnd;
  world.push_back({2, -0.8, 2, -0.68});
  world.push_back({2, 0.8, 2, 0.68});
  const auto diagram = LocalVoronoi(VoronoiConfig{}).compute(scan_of(world));
  ASSERT_TRUE(diagram.is_virtual);
  ASSERT_EQ(diagram.groups.groups.size(), 2U);
  const Eigen::Vector2d& last_m = diagram.groups.points.back().position_m;
  EXPECT_NEAR(std::abs(last_m.y()), 0.7, 0.1);  // the line meets the stub
  EXPECT_NEAR(last_m.x(), 2.0, 0.1);
}

// The robot is 0.525 m wide.
TEST(VirtualDiagram, NoBranchIsBeyondTheLineOrTooNarrowForTheRobot) {
  for (const double y_m : {-0.3, -0.1, 0.0, 0.05, 0.3}) {
    for (const double heading_rad : {-0.3, -0.1, 0.0, 0.1, 0.3}) {
      SCOPED_TRACE(std::to_string(y_m) + " m, " + std::to_string(heading_rad) + " rad");
      const SeenDiagram seen_diagram = seen_from(y_m, heading_rad);
      for (const DiagramBranch& branch : seen_diagram.diagram.branches) {
        ASSERT_GE(branch.points.size(), 2U);
        for (const DiagramPoint& point : seen_diagram.diagram.points_of(branch)) {
          EXPECT_LT(point.position_m.y() * (seen_diagram.line_y_m < 0.0 ? -1.0 : 1.0),
                    std::abs(seen_diagram.line_y_m));
          EXPECT_GE(point.clearance_m, 0.2);
        }
      }
      EXPECT_EQ(seen_diagram.diagram.branches.back().points.end,
                seen_diagram.diagram.points.size());
    }
  }
}

// A dead end 0.5 m wide: the whole branch is narrower than the robot, which is still in it.
TEST(VirtualDiagram, AWayThatIsNarrowAllAlongStays) {
  const World narrow{{-6, 0.25, 4, 0.25}, {4, 0.25, 4, -0.25}, {4, -0.25, -6, -0.25}};
  const auto diagram = LocalVoronoi(VoronoiConfig{}).compute(scan_of(narrow));
  EXPECT_TRUE(diagram.is_virtual);
  ASSERT_EQ(diagram.branches.size(), 1U);
  const auto points = diagram.points_of(diagram.branches[0]);
  ASSERT_GE(points.size(), 2U);
  EXPECT_GT((points.back().position_m - points.front().position_m).norm(), 2.0);
}

}  // namespace
}  // namespace topogeo::voronoi
