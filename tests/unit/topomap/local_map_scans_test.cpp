// Scans of every length and content as local maps: few and many beams, nothing in range, readings
// that are not finite, readings at the sensor.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "figure_maps.hpp"

namespace topogeo::topomap {
namespace {

using figure_scenes::describe;
using figure_scenes::expect_well_formed;
using figure_scenes::load_scene;
using figure_scenes::Made;
using figure_scenes::make_map;
using figure_scenes::Scene;
using figure_scenes::source_config;
using figure_scenes::source_map_config;

constexpr std::array<std::size_t, 7> kBeamCounts{1, 2, 180, 181, 360, 361, 1081};

/// `count` beams evenly over a field of view around the forward direction.
simulation::BeamPattern beams_over(double view_deg, std::size_t count) {
  const double view_rad = view_deg * std::numbers::pi / 180.0;
  // A full turn must not repeat a beam.
  const std::size_t steps = view_deg >= 360.0 ? count : std::max<std::size_t>(count, 2) - 1;
  return {.angle_min_rad = count > 1 ? -0.5 * view_rad : 0.0,
          .angle_step_rad = view_rad / static_cast<double>(steps),
          .count = count};
}

TEST(ScansAsLocalMaps, AnyNumberOfBeamsGivesAWellFormedMap) {
  for (const std::string& number : figure_scenes::scene_numbers()) {
    const Scene scene = load_scene(number);
    for (const std::size_t count : kBeamCounts) {
      for (const double view_deg : {60.0, 180.0, 270.0, 360.0}) {
        SCOPED_TRACE(number + ", " + std::to_string(count) + " beams over " +
                     std::to_string(view_deg));
        const scan::Scan scan = figure_scenes::scan_of(scene.world, scene.T_world_laser[0],
                                                       beams_over(view_deg, count));
        const Made made = make_map(scan, source_config(), source_map_config());
        expect_well_formed(made.map, made.diagram.is_virtual);
        EXPECT_LE(made.map.points.size(), count);
        // One or two beams are small groups, which are all dropped.
        EXPECT_TRUE(count > 2 || made.diagram.is_virtual);
        const Made defaults = make_map(scan, {}, {});
        expect_well_formed(defaults.map, defaults.diagram.is_virtual);
      }
    }
  }
}

// Figure 5.5 with 180 to 1081 beams ahead: the same nodes, with better positions for more beams.
TEST(ScansAsLocalMaps, TheNumberOfBeamsDoesNotChangeWhatIsSeen) {
  const Scene scene = load_scene("5_05");
  for (const std::size_t count : {180U, 181U, 360U, 361U, 1081U}) {
    SCOPED_TRACE(count);
    const auto seen =
        see_map(scene, source_config(), source_map_config(), beams_over(180.0, count));
    EXPECT_THAT(seen.node_names(),
                testing::ElementsAre("door B|C", "fictitious A|B", "fictitious A|C",
                                     "fictitious B|D", "real A|B|C", "real B|C|D"));
    expect_node(seen, "real A|B|C", {1.05, 0.1506}, count < 300 ? 0.05 : 0.02);
    expect_node(seen, "real B|C|D", {1.05, 1.7337}, count < 300 ? 0.05 : 0.02);
    expect_node(seen, "door B|C", {1.05, 1.1}, 0.06);
  }
}

scan::Scan scan_with_all(float range_m, double view_deg = 180.0, std::size_t count = 361) {
  const simulation::BeamPattern beams = beams_over(view_deg, count);
  scan::Scan scan;
  scan.angle_min_rad = beams.angle_min_rad;
  scan.angle_step_rad = beams.angle_step_rad;
  scan.ranges_m.assign(count, range_m);
  return scan;
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(ScansAsLocalMaps, WithoutAReadingInRangeTheMapIsVirtual) {
  for (const float range_m : {49.0F, 0.0F, kNan, kInfinity, -kInfinity, -1.0F}) {
    for (const double view_deg : {180.0, 360.0}) {
      for (const std::size_t count : kBeamCounts) {
        SCOPED_TRACE(std::to_string(range_m) + " m, " + std::to_string(count) + " beams over " +
                     std::to_string(view_deg));
        const Made made =
            make_map(scan_with_all(range_m, view_deg, count), source_config(), source_map_config());
        EXPECT_TRUE(made.diagram.is_virtual);
        expect_well_formed(made.map, true);
        EXPECT_TRUE(made.map.points.empty());
        // The path straight ahead, for navigation.
        EXPECT_TRUE(count < 180 || made.map.branches.size() == 1);
      }
    }
  }
}

TEST(ScansAsLocalMaps, NoBeamAtAllGivesAnEmptyMap) {
  const Made made = make_map(scan_with_all(0.0F, 180.0, 0), source_config(), source_map_config());
  EXPECT_TRUE(made.map.nodes.empty());
  EXPECT_TRUE(made.map.branches.empty());
  EXPECT_TRUE(made.map.points.empty());
}

/// Changes every 37th beam from the tenth on, away from the borders of groups.
void spoil(scan::Scan& scan, const std::vector<float>& with_m) {
  for (std::size_t i = 10, n = 0; i < scan.ranges_m.size(); i += 37, ++n) {
    scan.ranges_m[i] = with_m[n % with_m.size()];
  }
}

TEST(ScansAsLocalMaps, BeamsWithoutANumberLeaveTheGroupsOfTheOthersAsTheyAre) {
  for (const std::string& number : figure_scenes::scene_numbers()) {
    SCOPED_TRACE(number);
    const Scene scene = load_scene(number);
    const scan::Scan good = figure_scenes::scan_of(scene.world, {});
    scan::Scan bad = good;
    spoil(bad, {kNan, kInfinity, -kInfinity, -2.0F});
    scan::Scan missing = good;
    spoil(missing, {scan::Scan::kNoReturn});

    const Made from_good = make_map(good, source_config(), source_map_config());
    const Made from_bad = make_map(bad, source_config(), source_map_config());
    const Made from_missing = make_map(missing, source_config(), source_map_config());
    // A beam with NaN equals a beam without a return, bit for bit.
    EXPECT_EQ(content_hash(from_bad.map), content_hash(from_missing.map));
    // The groups are those of the good scan without the spoilt beams.
    const auto names = figure_scenes::group_names(from_good.diagram, scene.world, {});
    EXPECT_EQ(figure_scenes::group_names(from_bad.diagram, scene.world, {}), names);
    std::vector<std::uint32_t> expected;
    if (!from_good.diagram.is_virtual) {
      for (const auto& point : from_good.diagram.groups.points) {
        if (point.beam % 37 != 10) expected.push_back(point.beam);
      }
      std::vector<std::uint32_t> found;
      for (const auto& point : from_bad.diagram.groups.points) found.push_back(point.beam);
      EXPECT_EQ(found, expected);
    }
    // Missing beams cut no branch: nodes and branches remain.
    EXPECT_EQ(describe(from_bad.map, names).branches, describe(from_good.map, names).branches);
  }
}

TEST(ScansAsLocalMaps, AReadingOnTheSensorIsDroppedAsASmallGroup) {
  for (const std::string& number : figure_scenes::scene_numbers()) {
    SCOPED_TRACE(number);
    const Scene scene = load_scene(number);
    const scan::Scan good = figure_scenes::scan_of(scene.world, {});
    const Made from_good = make_map(good, source_config(), source_map_config());
    scan::Scan bad = good;
    bad.ranges_m[100] = 0.001F;
    const Made from_bad = make_map(bad, source_config(), source_map_config());
    const auto names = figure_scenes::group_names(from_good.diagram, scene.world, {});
    EXPECT_EQ(figure_scenes::group_names(from_bad.diagram, scene.world, {}), names);
    expect_well_formed(from_bad.map, from_bad.diagram.is_virtual);
    EXPECT_EQ(describe(from_bad.map, names).node_names(),
              describe(from_good.map, names).node_names());

    // When kept, it is an object at the robot; the map stays well-formed.
    voronoi::VoronoiConfig keep = source_config();
    keep.drop_small = false;
    const Made kept = make_map(bad, keep, source_map_config());
    expect_well_formed(kept.map, kept.diagram.is_virtual);
  }
}

TEST(ScansAsLocalMaps, ASensorThatIsCoveredSeesNoWay) {
  for (const double view_deg : {180.0, 360.0}) {
    const Made made =
        make_map(scan_with_all(0.001F, view_deg, 360), source_config(), source_map_config());
    EXPECT_TRUE(made.diagram.is_virtual);
    EXPECT_TRUE(made.map.branches.empty());
    EXPECT_TRUE(made.map.nodes.empty());
    EXPECT_EQ(made.map.points.size(), 360U);
  }
}

}  // namespace
}  // namespace topogeo::topomap
