#include "topogeo/voronoi/local_voronoi.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "test_world.hpp"

namespace topogeo::voronoi {
namespace {

using geometry::Pose2;
using test_world::Laser;
using test_world::random_world;
using test_world::scan_of;
using test_world::World;

LocalVoronoiDiagram diagram_of(const scan::Scan& scan, const VoronoiConfig& config = {}) {
  return LocalVoronoi(config).compute(scan);
}

double distance_to_group(std::span<const Site> sites, std::uint16_t group,
                         const Eigen::Vector2d& at) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Site& site : sites) {
    if (site.group == group) nearest_m = std::min(nearest_m, (site.position_m - at).norm());
  }
  return nearest_m;
}

/// A whole diagram as bytes, so that equality is bit for bit.
std::string bytes_of(const LocalVoronoiDiagram& diagram) {
  std::string bytes;
  const auto add = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  for (const DiagramNode& node : diagram.nodes) {
    add(node.position_m.x());
    add(node.position_m.y());
    add(node.clearance_m);
    for (const std::uint16_t group : diagram.groups_of(node)) add(group);
  }
  for (const DiagramBranch& branch : diagram.branches) {
    add(branch.node_a);
    add(branch.node_b);
    add(branch.base_groups);
    add(branch.points.begin);
    add(branch.points.end);
  }
  for (const DiagramPoint& point : diagram.points) {
    add(point.position_m.x());
    add(point.position_m.y());
    add(point.clearance_m);
  }
  return bytes;
}

// y = 1.2  ----------------------
//          robot >
// y = -0.8 ----------------------
TEST(LocalVoronoi, ACorridorIsOneBranchOnItsAxis) {
  const World corridor{{-3, 1.2, 30, 1.2}, {-3, -0.8, 30, -0.8}};
  const LocalVoronoiDiagram diagram = diagram_of(scan_of(corridor));
  EXPECT_FALSE(diagram.is_virtual);
  EXPECT_EQ(diagram.groups.groups.size(), 2U);
  EXPECT_TRUE(diagram.nodes.empty());
  ASSERT_EQ(diagram.branches.size(), 1U);
  EXPECT_EQ(diagram.branches[0].node_a, DiagramBranch::kLoose);
  EXPECT_EQ(diagram.branches[0].node_b, DiagramBranch::kLoose);
  const auto points = diagram.points_of(diagram.branches[0]);
  ASSERT_GT(points.size(), 60U);
  for (const DiagramPoint& point : points) {
    if (point.position_m.x() > 4.0) continue;  // beyond, readings on the wall are far apart
    EXPECT_NEAR(point.position_m.y(), 0.2, 0.02);
    EXPECT_NEAR(point.clearance_m, 1.0, 0.02);
  }
}

//         |
//  -------+ | wall at x = 4
//  robot >  |
//  -------+ |
//         |
TEST(LocalVoronoi, ATJunctionIsOneNodeOfThreeBranches) {
  const World junction{{-3, 1, 2, 1}, {2, 1, 2, 6}, {-3, -1, 2, -1}, {2, -1, 2, -6}, {4, -6, 4, 6}};
  const LocalVoronoiDiagram diagram = diagram_of(scan_of(junction));
  ASSERT_EQ(diagram.nodes.size(), 1U);
  EXPECT_EQ(diagram.nodes[0].base_groups.size(), 3U);
  // Equally far from the corners (2, +-1) and the wall: (x - 2)^2 + 1 = (4 - x)^2.
  EXPECT_NEAR(diagram.nodes[0].position_m.x(), 2.75, 0.05);
  EXPECT_NEAR(diagram.nodes[0].position_m.y(), 0.0, 0.05);
  EXPECT_NEAR(diagram.nodes[0].clearance_m, 1.25, 0.05);
  ASSERT_EQ(diagram.branches.size(), 3U);
  for (const DiagramBranch& branch : diagram.branches) {
    EXPECT_NE(branch.node_a == DiagramBranch::kLoose, branch.node_b == DiagramBranch::kLoose);
    const std::size_t end = branch.node_a == 0 ? branch.points.begin : branch.points.end - 1;
    EXPECT_EQ(diagram.points[end].position_m, diagram.nodes[0].position_m);
  }
}

TEST(LocalVoronoi, FourGroupsAtACrossingAreOneNode) {
  const World crossing{{-3, 1, 2, 1},
                       {-3, -1, 2, -1},
                       {4, 1, 9, 1},
                       {4, -1, 9, -1},
                       {12, -3, 12, 3}};  // beyond the range limit, but it proves free space
  const LocalVoronoiDiagram diagram = diagram_of(scan_of(crossing));
  ASSERT_EQ(diagram.nodes.size(), 1U);
  EXPECT_EQ(diagram.nodes[0].base_groups.size(), 4U);
  EXPECT_NEAR(diagram.nodes[0].position_m.x(), 3.0, 0.05);
  EXPECT_NEAR(diagram.nodes[0].position_m.y(), 0.0, 0.02);
}

//  --------------------------
//  robot >      [box]
//  --------------------------
TEST(LocalVoronoi, PiecesOfTheSameGroupsThatDoNotTouchAreTwoBranches) {
  const World world{{-1, 1.5, 9, 1.5},  {-1, -1.5, 9, -1.5},   {3, -0.3, 3, 0.3},
                    {3, 0.3, 3.5, 0.3}, {3.5, 0.3, 3.5, -0.3}, {3.5, -0.3, 3, -0.3},
                    {14, -9, 14, 9}};
  const LocalVoronoiDiagram diagram = diagram_of(scan_of(world, {0.0, 0.9, 0.0}));
  ASSERT_EQ(diagram.groups.groups.size(), 3U);
  std::map<std::array<std::uint16_t, 2>, std::vector<double>> first_x_m;
  for (const DiagramBranch& branch : diagram.branches) {
    first_x_m[branch.base_groups].push_back(
        std::ranges::min(diagram.points_of(branch), {}, [](const DiagramPoint& point) {
          return point.position_m.x();
        }).position_m.x());
  }
  // Beams go from right to left: the right wall is the first group, the box the second.
  auto between_walls = first_x_m.at({0, 2});
  std::ranges::sort(between_walls);
  ASSERT_EQ(between_walls.size(), 2U);
  EXPECT_LT(between_walls[0], 0.5);  // in front of the box
  EXPECT_GT(between_walls[1], 4.0);  // behind it
  EXPECT_EQ(first_x_m.at({1, 2}).size(), 1U);
}

TEST(LocalVoronoi, OneWallGivesAVirtualDiagramBesideTheRobot) {
  const LocalVoronoiDiagram diagram = diagram_of(scan_of({{-3, 1, 30, 1}}));
  EXPECT_TRUE(diagram.is_virtual);
  EXPECT_EQ(diagram.groups.groups.size(), 2U);
  ASSERT_EQ(diagram.branches.size(), 1U);
  for (const DiagramPoint& point : diagram.points_of(diagram.branches[0])) {
    EXPECT_NEAR(point.position_m.y(), 0.0, 0.1);  // straight ahead, between the wall and its image
  }
}

TEST(LocalVoronoi, NothingInSightGivesAVirtualDiagramStraightAhead) {
  VoronoiConfig config;
  config.forward_rad = 0.5;
  scan::Scan scan = scan_of({});
  const LocalVoronoiDiagram diagram = diagram_of(scan, config);
  EXPECT_TRUE(diagram.is_virtual);
  ASSERT_EQ(diagram.branches.size(), 1U);
  const auto points = diagram.points_of(diagram.branches[0]);
  EXPECT_GT((points.back().position_m - points.front().position_m).norm(), 8.0);
  for (const DiagramPoint& point : points) {
    EXPECT_NEAR(std::cos(0.5) * point.position_m.y() - std::sin(0.5) * point.position_m.x(), 0.0,
                0.02);
  }
}

TEST(LocalVoronoi, ScansOfAnyLengthAndContentGiveADiagram) {
  const World world = random_world(7);
  for (const std::size_t beams : {1U, 2U, 180U, 181U, 360U, 361U, 1081U}) {
    for (const double view_deg : {60.0, 180.0, 270.0, 360.0}) {
      const auto diagram =
          diagram_of(scan_of(world, {}, {.beams = beams, .field_of_view_deg = view_deg}));
      EXPECT_TRUE(diagram.is_virtual || diagram.groups.groups.size() >= 2);
      EXPECT_TRUE(beams <= 2 || !diagram.branches.empty()) << beams << " over " << view_deg;
    }
  }
  scan::Scan scan;
  scan.angle_step_rad = 0.01;
  EXPECT_TRUE(diagram_of(scan).branches.empty());  // no beam at all
  scan.ranges_m.assign(300, 0.001F);               // at the sensor
  EXPECT_TRUE(diagram_of(scan).nodes.empty());
  scan.ranges_m.assign(300, std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(diagram_of(scan).is_virtual);
  scan.angle_step_rad = -0.01;
  EXPECT_THROW(diagram_of(scan), std::invalid_argument);
}

TEST(LocalVoronoi, AMissingBeamDoesNotCutABranch) {
  const World corridor{{-3, 1.2, 6, 1.2}, {-3, -0.8, 6, -0.8}};
  scan::Scan scan = scan_of(corridor);
  scan.ranges_m[200] = scan.ranges_m[201] = scan::Scan::kNoReturn;
  EXPECT_EQ(diagram_of(scan).branches.size(), 1U);
}

TEST(LocalVoronoi, BranchPointsAreEquallyFarFromTheirGroupsOnRandomScenes) {
  double sum_m = 0.0;
  int count = 0;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    const Laser laser{.beams = seed % 2 == 0 ? 361U : 720U,
                      .field_of_view_deg = seed % 2 == 0 ? 180.0 : 360.0};
    const VoronoiConfig config;
    LocalVoronoi voronoi{config};
    const LocalVoronoiDiagram diagram = voronoi.compute(scan_of(random_world(seed), {}, laser));
    for (const DiagramBranch& branch : diagram.branches) {
      const auto points = diagram.points_of(branch);
      for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        const Eigen::Vector2d& at = points[i].position_m;
        const double a_m = distance_to_group(voronoi.sites(), branch.base_groups[0], at);
        const double b_m = distance_to_group(voronoi.sites(), branch.base_groups[1], at);
        // The nearest point of a group can change within a cell.
        ASSERT_NEAR(a_m, b_m, config.resolution_m) << "seed " << seed << " at " << at.transpose();
        ASSERT_NEAR(points[i].clearance_m, a_m, config.resolution_m);
        sum_m += std::abs(a_m - b_m);
        ++count;
      }
    }
  }
  ASSERT_GT(count, 3000);
  EXPECT_LT(sum_m / count, 0.001);
}

TEST(LocalVoronoi, DiagramsAreWellFormedOnRandomScenes) {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    const VoronoiConfig config;
    const LocalVoronoiDiagram diagram = diagram_of(
        scan_of(random_world(seed), {}, {.beams = 541, .field_of_view_deg = 270.0}), config);
    std::vector<int> degree(diagram.nodes.size(), 0);
    for (const DiagramBranch& branch : diagram.branches) {
      ASSERT_GE(branch.points.size(), 2U);
      ASSERT_LT(branch.base_groups[0], branch.base_groups[1]);
      for (const std::uint32_t node : {branch.node_a, branch.node_b}) {
        if (node == DiagramBranch::kLoose) continue;
        ++degree[node];
        const auto groups = diagram.groups_of(diagram.nodes[node]);
        EXPECT_TRUE(std::ranges::includes(groups, branch.base_groups)) << "seed " << seed;
      }
      const auto points = diagram.points_of(branch);
      for (std::size_t i = 1; i < points.size(); ++i) {
        EXPECT_LE((points[i].position_m - points[i - 1].position_m).norm(),
                  2.0 * config.resolution_m + config.node_merge_m);
      }
    }
    for (std::size_t i = 0; i < degree.size(); ++i) {
      EXPECT_GE(degree[i], 1);
      EXPECT_GE(diagram.nodes[i].base_groups.size(), 3U);
      EXPECT_TRUE(std::ranges::is_sorted(diagram.groups_of(diagram.nodes[i])));
    }
  }
}

TEST(LocalVoronoi, TurningTheLaserTurnsTheDiagram) {
  // Junctions ahead and behind.
  const World world{{-2, 1, 2, 1}, {2, 1, 2, 6},   {-2, -1, 2, -1},  {2, -1, 2, -6},
                    {4, -6, 4, 6}, {-2, 1, -2, 6}, {-2, -1, -2, -6}, {-3.5, -6, -3.5, 6}};
  const Laser laser{.beams = 720, .field_of_view_deg = 360.0};
  const LocalVoronoiDiagram straight = diagram_of(scan_of(world, {}, laser));
  ASSERT_GE(straight.nodes.size(), 2U);
  for (const double turn_rad : {M_PI / 2.0, M_PI, 20.0 * M_PI / 180.0}) {
    const Pose2 T_world_laser{0.0, 0.0, turn_rad};
    const LocalVoronoiDiagram turned = diagram_of(scan_of(world, T_world_laser, laser));
    ASSERT_EQ(turned.nodes.size(), straight.nodes.size());
    for (const DiagramNode& node : turned.nodes) {
      const Eigen::Vector2d at = T_world_laser * node.position_m;
      const bool found = std::ranges::any_of(straight.nodes, [&](const DiagramNode& other) {
        return (other.position_m - at).norm() < 0.05 &&
               std::abs(other.clearance_m - node.clearance_m) < 0.02;
      });
      EXPECT_TRUE(found) << at.transpose();
    }
  }
}

/// The beams of each group, counted from beam `first` of a full turn, in canonical order.
std::vector<std::vector<std::size_t>> beams_of_groups(const LocalVoronoiDiagram& diagram,
                                                      std::size_t first, std::size_t count) {
  std::vector<std::vector<std::size_t>> groups;
  for (const PointRun& run : diagram.groups.groups) {
    std::vector<std::size_t>& beams = groups.emplace_back();
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      beams.push_back((diagram.groups.points[i].beam + first) % count);
    }
    std::ranges::sort(beams);
  }
  std::ranges::sort(groups);
  return groups;
}

TEST(LocalVoronoi, GroupsAndFreeSpaceOfAFullTurnDoNotDependOnItsFirstBeam) {
  constexpr std::size_t kBeams = 360;
  VoronoiConfig as_in_the_source;
  as_in_the_source.alternate_behind_only = false;
  as_in_the_source.alternate_large_only = false;
  VoronoiConfig hidden_zones;
  hidden_zones.join_hidden_zones = true;
  for (VoronoiConfig config : {VoronoiConfig{}, as_in_the_source, hidden_zones}) {
    config.resolution_m = 0.2;  // groups are independent of it
    for (std::uint32_t seed = 0; seed < 60; ++seed) {
      scan::Scan scan =
          scan_of(random_world(seed), {}, {.beams = kBeams, .field_of_view_deg = 360.0});
      scan.ranges_m.front() = scan.ranges_m.back() = scan::Scan::kNoReturn;  // a drop-out
      LocalVoronoi voronoi{config};
      const LocalVoronoiDiagram diagram = voronoi.compute(scan);
      for (const std::size_t first : {90U, 175U, 250U}) {
        scan::Scan turned = scan;
        std::rotate(turned.ranges_m.begin(),
                    turned.ranges_m.begin() + static_cast<std::ptrdiff_t>(first),
                    turned.ranges_m.end());
        turned.angle_min_rad = geometry::wrap_angle(
            scan.angle_min_rad + static_cast<double>(first) * scan.angle_step_rad);
        LocalVoronoi other{config};
        const LocalVoronoiDiagram again = other.compute(turned);
        ASSERT_EQ(again.is_virtual, diagram.is_virtual) << "seed " << seed;
        if (diagram.is_virtual) continue;  // its points are on the beams nearest to a line
        EXPECT_EQ(beams_of_groups(again, first, kBeams), beams_of_groups(diagram, 0, kBeams))
            << "seed " << seed;
        for (std::size_t i = 0; i < kBeams; ++i) {
          ASSERT_EQ(other.free_range_m()[i], voronoi.free_range_m()[(i + first) % kBeams])
              << "seed " << seed << " beam " << i;
        }
      }
    }
  }
}

TEST(LocalVoronoi, AScanGivesTheSameBytesWhateverCameBefore) {
  const scan::Scan first = scan_of(random_world(1));
  const scan::Scan other = scan_of(random_world(2), {}, {.beams = 720, .field_of_view_deg = 360.0});
  const scan::Scan third = scan_of(random_world(3));
  LocalVoronoi voronoi{VoronoiConfig{}};
  const std::string bytes = bytes_of(voronoi.compute(first));
  EXPECT_EQ(bytes_of(voronoi.compute(first)), bytes);
  LocalVoronoiDiagram reused;
  for (const scan::Scan* scan : {&other, &third, &first}) voronoi.compute(*scan, reused);
  EXPECT_EQ(bytes_of(reused), bytes);
  EXPECT_NE(bytes_of(voronoi.compute(third)), bytes);
}

TEST(VoronoiConfig, AValueOutsideItsRangeIsNamed) {
  VoronoiConfig config;
  EXPECT_NO_THROW(check(config));
  config.resolution_m = 0.0;
  EXPECT_THAT([&] { LocalVoronoi{config}; },
              testing::ThrowsMessage<std::invalid_argument>(testing::StrEq(
                  "key 'local_map.resolution_m' = '0': expected number between 0.01 and 1 m")));
}

TEST(VoronoiConfig, AGridOfTooManyCellsIsRefused) {
  VoronoiConfig config;
  config.range_limit_m = 100.0;
  config.resolution_m = 0.02;
  EXPECT_THAT([&] { LocalVoronoi{config}; },
              testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("2000 cells")));
}

}  // namespace
}  // namespace topogeo::voronoi
