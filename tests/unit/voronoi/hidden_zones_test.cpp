// Hidden zones (4.11, 4.12) for any field of view and mounting: the direction of the robot's motion
// decides which groups join, not that of the laser. Behind the robot the rules are mirrored: rear
// right as ahead on the left, rear left as ahead on the right.
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "figure_scenes.hpp"

namespace topogeo::voronoi {
namespace {

using figure_scenes::load_scene;
using figure_scenes::Scene;
using figure_scenes::source_config;
using testing::ElementsAre;
using testing::UnorderedElementsAre;

/// Groups in beam order of a laser that faces `looks_deg` to the left of the robot's motion, which
/// is along x. A full turn has 720 beams, otherwise there is one for each half degree.
std::vector<std::string> groups_seen(const Scene& scene, double looks_deg, double view_deg,
                                     bool hidden_zones = true) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  const simulation::BeamPattern beams{
      .angle_min_rad = -0.5 * view_deg * kDegree,
      .angle_step_rad = 0.5 * kDegree,
      .count = static_cast<std::size_t>(2.0 * view_deg) + (view_deg < 360.0 ? 1U : 0U)};
  VoronoiConfig config = source_config();
  config.join_hidden_zones = hidden_zones;
  config.forward_rad = geometry::wrap_angle(-looks_deg * kDegree);
  const geometry::Pose2 T_world_laser{0.0, 0.0, geometry::wrap_angle(looks_deg * kDegree)};
  LocalVoronoi voronoi(config);
  const LocalVoronoiDiagram diagram =
      voronoi.compute(figure_scenes::scan_of(scene.world, T_world_laser, beams));
  return figure_scenes::group_names(diagram, scene.world, T_world_laser);
}

TEST(HiddenZones, ACornerHidesAZoneInEachQuadrantHoweverTheLaserIsMounted) {
  const Scene scene = load_scene("4_14a");
  for (const double looks_deg : {0.0, 45.0, 90.0, 180.0, -90.0, -130.0}) {
    SCOPED_TRACE(looks_deg);
    EXPECT_THAT(groups_seen(scene, looks_deg, 360.0, false),
                UnorderedElementsAre("A", "B", "C", "D", "E", "F"));
    EXPECT_THAT(groups_seen(scene, looks_deg, 360.0), UnorderedElementsAre("ABF", "CDE"));
  }
}

TEST(HiddenZones, AQuadrantIsThatOfTheMotionForEveryFieldOfView) {
  const Scene scene = load_scene("4_14a");
  EXPECT_THAT(groups_seen(scene, 0.0, 180.0), ElementsAre("AB", "CD"));
  EXPECT_THAT(groups_seen(scene, 180.0, 180.0), ElementsAre("DE", "AF"));
  // Facing left: one group, so a virtual one comes after it.
  EXPECT_THAT(groups_seen(scene, 90.0, 180.0), ElementsAre("CDE", "*"));
  // 270 degrees, facing left: the last visible parts of the far side, ahead and behind, are two
  // groups.
  EXPECT_THAT(groups_seen(scene, 90.0, 270.0), ElementsAre("AB", "CDE", "AF"));
  EXPECT_THAT(groups_seen(scene, -90.0, 270.0), ElementsAre("DE", "ABF", "CD"));
  EXPECT_THAT(groups_seen(scene, 180.0, 270.0), ElementsAre("DE", "AF"));
  // 60 degrees, facing ahead: the beams of the corners are at -31 and 36 degrees.
  EXPECT_THAT(groups_seen(scene, 0.0, 60.0), ElementsAre("B", "C"));
}

TEST(HiddenZones, OnlyTheJumpAwayFromTheRobotHidesAZone) {
  const Scene scene = load_scene("4_14b");
  for (const double looks_deg : {0.0, 45.0, 90.0, 180.0, -90.0, -130.0}) {
    SCOPED_TRACE(looks_deg);
    EXPECT_THAT(groups_seen(scene, looks_deg, 360.0, false),
                UnorderedElementsAre("A", "B", "C", "D", "E", "F", "G", "H", "I", "J"));
    EXPECT_THAT(groups_seen(scene, looks_deg, 360.0),
                UnorderedElementsAre("AJ", "B", "CG", "DI", "E", "FH"));
  }
  EXPECT_THAT(groups_seen(scene, 0.0, 180.0), ElementsAre("B", "CG", "FH", "E"));
  EXPECT_THAT(groups_seen(scene, 180.0, 180.0), ElementsAre("E", "DI", "AJ", "B"));
}

}  // namespace
}  // namespace topogeo::voronoi
