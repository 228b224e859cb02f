// Aligning and merging maps of one floor from separate drives.
#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/exchange/align.hpp"
#include "topogeo/exchange/grid_map.hpp"
#include "topogeo/exchange/inspect.hpp"
#include "topogeo/exchange/merge.hpp"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/world/world.hpp"

#include "planning/floors.hpp"
#include "sample_floor.hpp"

namespace topogeo::exchange {
namespace {

using geometry::Pose2;
using testing::HasSubstr;

constexpr const char* kFloor = TOPOGEO_SHARE "/worlds/floor.world.yaml";

/// A part of a drive as a map of its own, in the frame of its first stop.
struct PartOfDrive {
  storage::MapDocument map;
  std::vector<Pose2> truth;  ///< T_world_robot of each stop
  Pose2 T_world_map;
};

PartOfDrive map_part(double from, double to, const std::string& robot) {
  static const simulation::SimulatedLog kLog =
      simulation::simulate_log(world::load_world(kFloor), {});
  const auto count = static_cast<double>(kLog.scans.size());
  const auto begin = static_cast<std::size_t>(from * count);
  const auto end = static_cast<std::size_t>(to * count);
  pipeline::MappingRun run(pipeline::load_config({}).config, robot);
  for (std::size_t i = begin; i < end; ++i) {
    scan::Scan scan = kLog.scans[i];
    scan.sequence -= begin;
    run.add(scan);
  }
  PartOfDrive part{run.finish(), {}, kLog.T_world_robot[begin]};
  for (const topomap::LocalMap& map : part.map.local_maps) {
    part.truth.push_back(kLog.T_world_robot[begin + map.sequence]);
  }
  return part;
}

const PartOfDrive& first_part() {
  static const PartOfDrive kPart = map_part(0.0, 0.65, "robot-1");
  return kPart;
}
const PartOfDrive& second_part() {
  static const PartOfDrive kPart = map_part(0.4, 1.0, "robot-2");
  return kPart;
}

void expect_near(const Pose2& a, const Pose2& b, double most_m, double most_rad) {
  EXPECT_NEAR(a.x_m, b.x_m, most_m);
  EXPECT_NEAR(a.y_m, b.y_m, most_m);
  EXPECT_NEAR(geometry::wrap_angle(a.theta_rad - b.theta_rad), 0.0, most_rad);
}

planning::OccupancyGrid floor_grid() {
  return *pipeline::read_drawing(kFloor, std::nullopt, 0.1).grid;
}

storage::MapDocument map_of(const planning::OccupancyGrid& grid) {
  return map_of_grid(planning::FreeSpace(grid), {}, {}, "drawing");
}

TEST(Align, TwoPartsOfADriveFindEachOther) {
  const Alignment found = align(first_part().map, second_part().map);
  EXPECT_TRUE(found.found) << found.reason;
  const Pose2 truth = geometry::between(first_part().T_world_map, second_part().T_world_map);
  // Both maps have errors of some centimetres themselves.
  expect_near(found.T_map_foreign, truth, 0.15, 0.02);
  EXPECT_GT(found.confidence, 0.3);
  const Alignment back = align(second_part().map, first_part().map);
  EXPECT_TRUE(back.found) << back.reason;
  expect_near(geometry::inverse(back.T_map_foreign), found.T_map_foreign, 0.1, 0.01);
}

TEST(Align, TheSmallerMapIsSearchedInTheLargerWhicheverComesFirst) {
  const storage::MapDocument floor = map_of(floor_grid());
  const storage::MapDocument corner = map_part(0.4, 0.5, "robot-3").map;
  const Alignment corner_in_floor = align(floor, corner);
  const Alignment floor_in_corner = align(corner, floor);
  EXPECT_TRUE(corner_in_floor.found) << corner_in_floor.reason;
  EXPECT_TRUE(floor_in_corner.found) << floor_in_corner.reason;
  EXPECT_EQ(floor_in_corner.searched, corner_in_floor.searched);
  EXPECT_EQ(floor_in_corner.T_map_foreign, geometry::inverse(corner_in_floor.T_map_foreign));
}

TEST(Align, ADrawingOfTheFloorIsFoundInItsMap) {
  const Alignment found = align(first_part().map, map_of(floor_grid()));
  EXPECT_TRUE(found.found) << found.reason;
  expect_near(found.T_map_foreign, geometry::inverse(first_part().T_world_map), 0.1, 0.02);
}

TEST(Align, ATurnedDrawingIsFound) {
  planning::GridFrame frame = floor_grid().frame();
  const Pose2 T{12.0, -30.0, 2.3};
  frame.T_map_grid = T * frame.T_map_grid;
  planning::OccupancyGrid turned(frame);
  const planning::OccupancyGrid grid = floor_grid();
  for (std::size_t i = 0; i < frame.size(); ++i) turned.set(frame.cell_at(i), grid.cells()[i]);
  const Alignment found = align(map_of(turned), map_of(grid));
  EXPECT_TRUE(found.found) << found.reason;
  expect_near(found.T_map_foreign, T, 0.05, 0.01);
}

/// L-shaped rooms of 8 x 5 m, side by side, without doors.
planning::OccupancyGrid rooms(int count) {
  planning::GridFrame frame;
  frame.columns = 100 * count;
  frame.rows = 60;
  planning::OccupancyGrid grid(frame, planning::CellState::kOccupied);
  for (int i = 0; i < count; ++i) {
    const std::int32_t left = 100 * i;
    planning::fill_box(grid, {left + 5, 5}, {left + 84, 24}, planning::CellState::kFree);
    planning::fill_box(grid, {left + 5, 25}, {left + 34, 54}, planning::CellState::kFree);
  }
  return grid;
}

TEST(Align, ARoomThatIsThereTwiceIsRefused) {
  const Alignment once = align(map_of(rooms(1)), map_of(rooms(1)));
  EXPECT_TRUE(once.found) << once.reason;
  const Alignment twice = align(map_of(rooms(2)), map_of(rooms(1)));
  EXPECT_FALSE(twice.found);
  EXPECT_THAT(twice.reason, HasSubstr("ambiguous"));
  EXPECT_GT(twice.rivalry, 0.9);
}

TEST(Align, AnotherBuildingIsRefused) {
  const Alignment found = align(first_part().map, map_of(rooms(1)));
  EXPECT_FALSE(found.found) << found.confidence;
}

TEST(Align, MapsWithoutStopsAreNamed) {
  EXPECT_THAT(error_of([] { align(first_part().map, {}); }),
              HasSubstr("the foreign map: expected"));
  EXPECT_THAT(error_of([] { align({}, first_part().map); }), HasSubstr("the map: expected"));
  AlignSettings settings;
  settings.stops = 3;
  EXPECT_THROW(align(first_part().map, first_part().map, settings), std::invalid_argument);
}

/// Largest distance between equal stops, once the maps are aligned by the first one.
double apart_m(const storage::MapDocument& a, const storage::MapDocument& b) {
  const auto pose_in = [](const storage::MapDocument& map, const topomap::StopId& stop) {
    const auto at = std::ranges::find(map.trajectory.stops, stop, &topomap::StopPose::stop);
    EXPECT_NE(at, map.trajectory.stops.end());
    return at->T_map_robot;
  };
  const topomap::StopId first = a.trajectory.stops.front().stop;
  const Pose2 T_a_b = pose_in(a, first) * geometry::inverse(pose_in(b, first));
  double most_m = 0.0;
  for (const topomap::StopPose& stop : a.trajectory.stops) {
    const Pose2 other = T_a_b * pose_in(b, stop.stop);
    most_m = std::max(most_m, (other.position_m() - stop.T_map_robot.position_m()).norm());
  }
  return most_m;
}

/// The two parts, each with a drawing.
const MergedMap& merged_parts() {
  static const MergedMap kMerged = [] {
    storage::MapDocument a = first_part().map;
    storage::MapDocument b = second_part().map;
    a.drawing.places = {{"dock", {1.0, 0.5}}};
    b.drawing.places = {{"dock", {9.0, 9.0}}, {"lab", {0.5, 0.25}}};
    a.refused_merges = {{{1, 2}, {3, 4}}};
    b.refused_merges = {{{5, 6}, {7, 8}}};
    return merge(a, b, pipeline::load_config({}).config);
  }();
  return kMerged;
}

TEST(Merge, BothOrdersGiveTheSameMap) {
  const pipeline::Config config = pipeline::load_config({}).config;
  const MergedMap& ab = merged_parts();
  const MergedMap ba = merge(second_part().map, first_part().map, config);
  ASSERT_TRUE(ab.merged && ba.merged);
  EXPECT_EQ(ab.left_out, 0U);
  EXPECT_EQ(ab.document.robot_id, "robot-1");
  EXPECT_EQ(ba.document.robot_id, "robot-2");
  const std::size_t stops = first_part().truth.size() + second_part().truth.size();
  EXPECT_EQ(ab.document.local_maps.size(), stops);
  EXPECT_LT(apart_m(ab.document, ba.document), 0.02);
  // Each result is in the frame of its first map, whose first stop stays at the origin.
  const auto first_of = [](const storage::MapDocument& merged, const PartOfDrive& part) {
    return std::ranges::find(merged.trajectory.stops, part.map.local_maps[0].stop,
                             &topomap::StopPose::stop)
        ->T_map_robot;
  };
  expect_near(first_of(ab.document, first_part()), {}, 1e-9, 1e-9);
  expect_near(first_of(ba.document, second_part()), {}, 1e-9, 1e-9);
  EXPECT_TRUE(
      contradictions(storage::parse_map_file(storage::map_file_bytes(ab.document), "ab")).empty());
  EXPECT_EQ(summarize(ab.document).sessions, 2U);
  EXPECT_THAT(ab.document.refused_merges,
              testing::ElementsAre(storage::RefusedMerge{{1, 2}, {3, 4}},
                                   storage::RefusedMerge{{5, 6}, {7, 8}}));
}

TEST(Merge, TheResultIsAsTrueAsItsParts) {
  const MergedMap& merged = merged_parts();
  ASSERT_TRUE(merged.merged);
  // Pairs the stops of both by session and number.
  std::vector<std::pair<Pose2, Pose2>> pairs;
  for (const PartOfDrive* part : {&first_part(), &second_part()}) {
    for (std::size_t i = 0; i < part->truth.size(); ++i) {
      const auto at = std::ranges::find(merged.document.trajectory.stops,
                                        part->map.local_maps[i].stop, &topomap::StopPose::stop);
      ASSERT_NE(at, merged.document.trajectory.stops.end());
      pairs.emplace_back(first_part().T_world_map * at->T_map_robot, part->truth[i]);
    }
  }
  double worst_m = 0.0;
  for (const auto& [ours, truth] : pairs) {
    worst_m = std::max(worst_m, (ours.position_m() - truth.position_m()).norm());
  }
  EXPECT_LT(worst_m, 0.25);
}

TEST(Merge, WhatIsDrawnOnTheSecondMapComesAlong) {
  const MergedMap& merged = merged_parts();
  ASSERT_TRUE(merged.merged);
  const auto& places = merged.document.drawing.places;
  ASSERT_EQ(places.size(), 2U);
  const auto place = [&](const char* name) {
    return std::ranges::find(places, name, &planning::Place::name)->position_m;
  };
  EXPECT_EQ(place("dock"), Eigen::Vector2d(1.0, 0.5));
  const Pose2 T = geometry::between(first_part().T_world_map, second_part().T_world_map);
  EXPECT_LT((place("lab") - T * Eigen::Vector2d(0.5, 0.25)).norm(), 0.25);
}

TEST(Merge, TheSameSessionTwiceIsRefused) {
  EXPECT_THAT(
      error_of([] { merge(first_part().map, first_part().map, pipeline::load_config({}).config); }),
      HasSubstr("both maps have stops of session"));
}

TEST(Merge, MapsThatHaveNothingInCommonStayApart) {
  const MergedMap merged =
      merge(first_part().map, map_of(rooms(1)), pipeline::load_config({}).config);
  EXPECT_FALSE(merged.merged);
  EXPECT_THAT(merged.notes, testing::ElementsAre(HasSubstr("not aligned: ")));
}

}  // namespace
}  // namespace topogeo::exchange
