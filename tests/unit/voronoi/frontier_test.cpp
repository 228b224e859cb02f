#include "topogeo/voronoi/frontier.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "topogeo/voronoi/local_voronoi.hpp"

#include "test_world.hpp"

namespace topogeo::voronoi {
namespace {

using test_world::scan_of;
using test_world::World;

/// True if the scan proves a point to be free, by the definition.
bool is_seen(const LocalVoronoi& voronoi, const scan::Scan& scan, const Eigen::Vector2d& at_m) {
  const double turn_rad = 2.0 * M_PI;
  const double offset_rad = std::atan2(at_m.y(), at_m.x()) - scan.angle_min_rad;
  const double beam =
      (offset_rad - std::floor(offset_rad / turn_rad) * turn_rad) / scan.angle_step_rad;
  const auto last = static_cast<double>(scan.ranges_m.size() - 1);
  if (beam > last) return false;
  const auto before = static_cast<std::size_t>(beam);
  const std::size_t after = std::min(before + 1, scan.ranges_m.size() - 1);
  // Between two beams: up to the line between their ends.
  const auto end_m = [&](std::size_t i) {
    const double angle_rad = scan.angle_min_rad + static_cast<double>(i) * scan.angle_step_rad;
    return Eigen::Vector2d{voronoi.free_range_m()[i] * std::cos(angle_rad),
                           voronoi.free_range_m()[i] * std::sin(angle_rad)};
  };
  const Eigen::Vector2d a = end_m(before);
  const Eigen::Vector2d along = end_m(after) - a;
  const Eigen::Vector2d to = at_m - a;
  return before == after || along.x() * to.y() - along.y() * to.x() >= 0.0;
}

/// Frontier of a scan whose beams all meet a wall nearer than the range limit.
Frontier frontier_of(const scan::Scan& scan) {
  BeamDirections beams;
  beams.update(scan);
  GeneratorGroups groups;
  const VoronoiConfig config;
  make_generator_groups(scan, beams, config, groups);
  EXPECT_EQ(groups.groups.size(), 1U);
  const std::vector<double> free_range_m(scan.ranges_m.begin(), scan.ranges_m.end());
  Frontier frontier;
  frontier.compute(beams, free_range_m, groups, config.range_limit_m);
  return frontier;
}

// The circle of a branch point's clearance, sampled every 2 cm: depth of its hidden part.
TEST(Frontier, HiddenDepthsAreThoseOfTheCircleSampledPointByPoint) {
  constexpr double kStep_m = 0.02;
  int compared = 0;
  int hidden = 0;
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    VoronoiConfig config;
    config.range_limit_m = 6.0;
    const scan::Scan scan =
        scan_of(test_world::random_world(seed), {}, {.beams = 541, .field_of_view_deg = 270.0});
    LocalVoronoi voronoi{config};
    const LocalVoronoiDiagram diagram = voronoi.compute(scan);
    if (diagram.is_virtual) continue;
    for (std::size_t i = 0; i < diagram.points.size(); i += 7) {
      const DiagramPoint& point = diagram.points[i];
      double nearest_m = point.clearance_m;
      for (double x = -point.clearance_m; x <= point.clearance_m; x += kStep_m) {
        for (double y = -point.clearance_m; y <= point.clearance_m; y += kStep_m) {
          const double apart_m = std::hypot(x, y);
          if (apart_m >= nearest_m) continue;
          if (!is_seen(voronoi, scan, point.position_m + Eigen::Vector2d{x, y}))
            nearest_m = apart_m;
        }
      }
      const double sampled_m = point.clearance_m - nearest_m;
      EXPECT_NEAR(point.hidden_m, sampled_m, 0.06)
          << "seed " << seed << " at " << point.position_m.transpose();
      ++compared;
      hidden += sampled_m > 0.1 ? 1 : 0;
    }
  }
  EXPECT_GT(compared, 200);
  EXPECT_GT(hidden, 50);
  EXPECT_LT(hidden, compared - 50);
}

// A room with the robot in the middle and everything in view.
TEST(Frontier, AClosedRoomSeenAllRoundHasNone) {
  const World room{{-3, -2, 3, -2}, {3, -2, 3, 2}, {3, 2, -3, 2}, {-3, 2, -3, -2}};
  const scan::Scan scan = scan_of(room, {}, {.beams = 720, .field_of_view_deg = 360.0});
  Frontier frontier = frontier_of(scan);
  EXPECT_EQ(frontier.distance_m({1.0, 0.5}), std::numeric_limits<double>::infinity());
}

// The same with a laser that faces ahead: the part behind it is unseen.
TEST(Frontier, AFieldOfViewEndsAtItsOuterBeams) {
  const World room{{-3, -2, 3, -2}, {3, -2, 3, 2}, {3, 2, -3, 2}, {-3, 2, -3, -2}};
  const scan::Scan scan = scan_of(room);
  Frontier frontier = frontier_of(scan);
  EXPECT_NEAR(frontier.distance_m({1.2, 0.5}), 1.2, 1e-9);
  frontier.clear();
  EXPECT_EQ(frontier.distance_m({1.2, 0.5}), std::numeric_limits<double>::infinity());
}

// Two walls, with only the range limit between them ahead.
TEST(Frontier, TheRangeLimitIsAnArc) {
  const World corridor{{-3, 1, 30, 1}, {-3, -1, 30, -1}, {31, -9, 31, 9}};
  VoronoiConfig config;
  config.range_limit_m = 4.0;
  LocalVoronoi voronoi{config};
  const LocalVoronoiDiagram diagram = voronoi.compute(scan_of(corridor));
  ASSERT_FALSE(diagram.is_virtual);
  EXPECT_NEAR(voronoi.frontier().distance_m({3.5, 0.0}), 0.5, 1e-9);
  EXPECT_NEAR(voronoi.frontier().distance_m({2.0, 0.0}), 2.0, 1e-9);
  for (const DiagramPoint& point : diagram.points) {
    const double nearest_m = std::min(point.position_m.x(), 4.0 - point.position_m.norm());
    EXPECT_NEAR(point.hidden_m, std::max(0.0, point.clearance_m - nearest_m), 0.02);
  }
}

}  // namespace
}  // namespace topogeo::voronoi
