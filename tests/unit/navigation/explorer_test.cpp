// Small floors in text, cells of 0.25 m, forbidden cells 1: the choice of the next target.
#include "topogeo/navigation/explorer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planning/floors.hpp"

namespace topogeo::navigation {
namespace {

using planning::grid_of_text;
using testing::HasSubstr;

constexpr double kExplored_m = 0.25;

planning::HybridMap drawn_map(const std::vector<std::string>& lines,
                              const std::vector<planning::Passage>& passages = {}) {
  planning::InflationConfig inflation;
  inflation.forbidden_cells = 1.0;
  planning::FreeSpace space(grid_of_text(lines, kExplored_m), inflation);
  planning::ZoneConfig zones;
  zones.min_area_m2 = 0.2;
  planning::ZoneMap cut = passages.empty() ? planning::drawn_zones(space, {}, zones)
                                           : planning::zones_of_rooms(space, passages, zones);
  return {std::move(space), std::move(cut)};
}

/// Centre of the cell at this line and column of the text, counted from the last line.
Eigen::Vector2d explored_at(int column, int row) {
  return {kExplored_m * (column + 0.5), kExplored_m * (row + 0.5)};
}

geometry::Pose2 pose_at(int column, int row, double theta_rad = 0.0) {
  const Eigen::Vector2d point_m = explored_at(column, row);
  return {point_m.x(), point_m.y(), theta_rad};
}

ExplorerConfig small() {
  ExplorerConfig config;
  config.sure_m = 0.2;
  config.least_gap_m = 0.5;
  config.least_room_m2 = 0.5;
  return config;
}

std::optional<ExplorationTarget> next(const Explorer& explorer, const planning::HybridMap& map,
                                      const geometry::Pose2& T_map_robot,
                                      const topomap::GlobalMap& graph = {}) {
  return explorer.next(graph, map, planning::HybridPlanner(map), T_map_robot);
}

topomap::GlobalMap with_end(const Eigen::Vector2d& end_m) {
  topomap::GlobalMap graph;
  graph.nodes = {{1, topomap::NodeKind::kReal, explored_at(2, 2), 0.5, 1},
                 {2, topomap::NodeKind::kFictitious, end_m, 0.5, 1}};
  graph.branches = {{1, 1, 2, false, 1, {{explored_at(2, 2), 0.5}, {end_m, 0.5}}}};
  return graph;
}

const std::vector<std::string> kOpenRight = {
    "##################????", "#.................????", "#.................????",
    "#.................????", "#.................????", "#.................????",
    "##################????",
};

const std::vector<std::string> kClosed = {
    "##################", "#................#", "#................#", "#................#",
    "#................#", "#................#", "##################",
};

TEST(Explorer, GoesWhereTheKnownEnds) {
  const planning::HybridMap map = drawn_map(kOpenRight);
  Explorer explorer(small());
  explorer.set_visited({pose_at(3, 3)});
  const auto target = next(explorer, map, pose_at(3, 3));
  ASSERT_TRUE(target);
  EXPECT_EQ(target->kind, TargetKind::kGap);
  EXPECT_NEAR(target->position_m.x(), explored_at(17, 3).x(), 0.01);
  // The view is from the known side toward the unknown.
  EXPECT_LT(target->T_map_view.x_m, target->position_m.x());
  EXPECT_NEAR(target->T_map_view.theta_rad, 0.0, 1.0);
  EXPECT_GT(target->distance_m, 1.0);
}

TEST(Explorer, TheEndOfABranchIsAFrontierOnlyWhereSomethingIsUnknown) {
  const planning::HybridMap map = drawn_map(kOpenRight);
  ExplorerConfig config = small();
  config.least_gap_m = 10.0;  // no gaps
  Explorer explorer(config);
  explorer.set_visited({pose_at(3, 3)});
  const auto target = next(explorer, map, pose_at(3, 3), with_end(explored_at(17, 3)));
  ASSERT_TRUE(target);
  EXPECT_EQ(target->kind, TargetKind::kBranchEnd);
  EXPECT_EQ(target->position_m, explored_at(17, 3));
  EXPECT_FALSE(next(explorer, map, pose_at(3, 3), with_end(explored_at(9, 3))));
}

TEST(Explorer, NothingIsLeftOfAFloorThatIsKnown) {
  Explorer explorer(small());
  explorer.set_visited({pose_at(3, 3)});
  EXPECT_FALSE(next(explorer, drawn_map(kClosed), pose_at(3, 3), with_end(explored_at(16, 3))));
}

TEST(Explorer, WhatCannotBeReachedIsNoTarget) {
  // The right part borders the unknown, but behind a wall.
  const planning::HybridMap map = drawn_map({
      "#########################",
      "#.........#.........?????",
      "#.........#.........?????",
      "#.........#.........?????",
      "#.........#.........?????",
      "#.........#.........?????",
      "#########################",
  });
  Explorer explorer(small());
  explorer.set_visited({pose_at(4, 3)});
  EXPECT_FALSE(next(explorer, map, pose_at(4, 3)));
  explorer.set_visited({pose_at(14, 3)});
  EXPECT_TRUE(next(explorer, map, pose_at(14, 3)));
}

TEST(Explorer, ARoomThatWasSeenIsEnteredToo) {
  const std::vector<std::string> lines = {
      "#########################", "#.........#.............#", "#.........#.............#",
      "#.......................#", "#.......................#", "#.......................#",
      "#.........#.............#", "#.........#.............#", "#########################",
  };
  const planning::HybridMap map =
      drawn_map(lines, {{explored_at(10, 4), Eigen::Vector2d::UnitX(), 0.4}});
  ASSERT_EQ(map.zones().zones.size(), 2U);
  Explorer explorer(small());
  explorer.set_visited({pose_at(4, 4)});
  const auto target = next(explorer, map, pose_at(4, 4));
  ASSERT_TRUE(target);
  EXPECT_EQ(target->kind, TargetKind::kRoom);
  EXPECT_GT(target->T_map_view.x_m, explored_at(11, 4).x());
  explorer.set_visited({pose_at(4, 4), pose_at(11, 4)});  // the threshold is not inside
  EXPECT_TRUE(next(explorer, map, pose_at(4, 4)));
  explorer.set_visited({pose_at(4, 4), pose_at(16, 4)});
  EXPECT_FALSE(next(explorer, map, pose_at(4, 4)));
}

TEST(Explorer, ARoomWhoseDoorTheGraphDoesNotHaveIsEnteredToo) {
  const planning::HybridMap map = drawn_map({
      "############################",
      "#............#.............#",
      "#............#.............#",
      "#............#.............#",
      "#............#.............#",
      "#..........................#",
      "#..........................#",
      "#..........................#",
      "#............#.............#",
      "#............#.............#",
      "#............#.............#",
      "#............#.............#",
      "############################",
  });
  ASSERT_EQ(map.zones().zones.size(), 1U);
  Explorer explorer(small());
  explorer.set_visited({pose_at(4, 6)});
  const auto target = next(explorer, map, pose_at(4, 6));
  ASSERT_TRUE(target);
  EXPECT_EQ(target->kind, TargetKind::kRoom);
  EXPECT_GT(target->T_map_view.x_m, explored_at(13, 6).x());
  EXPECT_TRUE(explorer.open(*target, map));
  explorer.set_visited({pose_at(4, 6), pose_at(13, 6)});  // the threshold is not inside
  EXPECT_TRUE(explorer.open(*target, map));
  explorer.set_visited({pose_at(4, 6), pose_at(20, 6)});
  EXPECT_FALSE(explorer.open(*target, map));
  EXPECT_FALSE(next(explorer, map, pose_at(4, 6)));
}

TEST(Explorer, InATightPlaceAllThatIsSeenNearByCanBeReached) {
  const planning::HybridMap map = drawn_map({
      "################????",
      "#...#...........????",
      "#...#...........????",
      "#...............????",
      "#...#...........????",
      "#...#...........????",
      "################????",
  });
  Explorer explorer(small());
  explorer.set_visited({pose_at(2, 3), pose_at(8, 3)});
  // In the gap, nearer to the closet than to the open room.
  const auto target = next(explorer, map, {kExplored_m * 4.3, kExplored_m * 3.5, 0.0});
  ASSERT_TRUE(target);
  EXPECT_EQ(target->kind, TargetKind::kGap);
  EXPECT_GT(target->T_map_view.x_m, explored_at(5, 3).x());
}

TEST(Explorer, ASideOfAPassageThatWasNotSeenIsGoneTo) {
  const planning::HybridMap map = drawn_map({
      "#########????????",
      "#........????????",
      "#........????????",
      "#................",
      "#................",
      "#................",
      "#........????????",
      "#........????????",
      "#########????????",
  });
  ExplorerConfig config = small();
  config.least_gap_m = 10.0;
  Explorer explorer(config);
  explorer.set_visited({pose_at(3, 4)});
  topomap::GlobalMap graph;
  graph.nodes = {{1, topomap::NodeKind::kReal, explored_at(3, 4), 0.8, 1},
                 {2, topomap::NodeKind::kDoor, explored_at(9, 7), 0.4, 1}};
  graph.branches = {{1, 1, 2, false, 1, {{explored_at(3, 7), 0.8}, {explored_at(9, 7), 0.4}}}};
  const auto target = next(explorer, map, pose_at(3, 4), graph);
  ASSERT_TRUE(target);
  EXPECT_EQ(target->kind, TargetKind::kPassage);
  EXPECT_GT(target->position_m.x(), explored_at(9, 7).x());
}

TEST(Explorer, TheCheapestComesFirst) {
  const planning::HybridMap map = drawn_map({
      "?????????????????????????????",
      "#....########################",
      "#....#......................?",
      "#....#......................?",
      "#....#......................?",
      "#...........................?",
      "#...........................?",
      "#...........................?",
      "#############################",
  });
  ExplorerConfig config = small();
  config.unknown_near_m = 0.3;
  Explorer explorer(config);
  for (const int column : {3, 22}) {
    explorer.set_visited({pose_at(column, 2)});
    const auto target = next(explorer, map, pose_at(column, 2));
    ASSERT_TRUE(target) << column;
    EXPECT_EQ(target->position_m.x() > explored_at(13, 2).x(), column == 22);
  }
}

TEST(Explorer, WhatWasGivenUpDoesNotComeAgain) {
  const planning::HybridMap map = drawn_map(kOpenRight);
  Explorer explorer(small());
  explorer.set_visited({pose_at(3, 3)});
  for (int i = 0; i < 20; ++i) {
    const auto target = next(explorer, map, pose_at(3, 3));
    if (!target) break;
    EXPECT_TRUE(explorer.open(*target, map));
    explorer.give_up(*target);
  }
  EXPECT_FALSE(next(explorer, map, pose_at(3, 3)));
  EXPECT_GT(explorer.given_up(), 0U);
}

TEST(Explorer, ATargetIsClosedWhenTheMapShowsIt) {
  const planning::HybridMap map = drawn_map(kOpenRight);
  const planning::HybridMap later = drawn_map(kClosed);
  Explorer explorer(small());
  explorer.set_visited({pose_at(3, 3)});
  const auto target = next(explorer, map, pose_at(3, 3));
  ASSERT_TRUE(target);
  EXPECT_TRUE(explorer.open(*target, map));
  EXPECT_FALSE(explorer.open(*target, later));
}

TEST(Explorer, WhatShowsThroughAHoleTooSmallForTheRobotIsNoTarget) {
  // The left wall has holes of one cell, with much unknown area behind.
  const std::vector<std::string> lines = {
      "??????##################", "??????#................#", "????????...............#",
      "??????#................#", "??????#................#", "????????...............#",
      "??????#................#", "??????##################",
  };
  ExplorerConfig config = small();
  config.least_gap_m = kExplored_m;
  Explorer explorer(config);
  explorer.set_visited({pose_at(12, 3)});
  EXPECT_FALSE(next(explorer, drawn_map(lines), pose_at(12, 3)));
  EXPECT_FALSE(next(explorer, drawn_map(lines), pose_at(12, 3), with_end(explored_at(8, 2))));
  std::vector<std::string> wide = lines;
  for (const std::size_t line : {3U, 4U}) wide[line] = "????????...............#";
  EXPECT_TRUE(next(explorer, drawn_map(wide), pose_at(12, 3)));
}

TEST(Explorer, ALittleUnknownFloorIsNotGoneToFromFarAway) {
  // Half a square metre at the left end.
  const planning::HybridMap map = drawn_map({
      "##################################################",
      "#??..............................................#",
      "#??..............................................#",
      "#??..............................................#",
      "#??..............................................#",
      "#................................................#",
      "##################################################",
  });
  ExplorerConfig config = small();
  config.worth_m_per_m2 = 5.0;
  Explorer explorer(config);
  for (const int column : {5, 45}) {
    explorer.set_visited({pose_at(column, 3)});
    EXPECT_EQ(next(explorer, map, pose_at(column, 3)).has_value(), column == 5);
  }
  config.worth_m_per_m2 = 100.0;
  Explorer keen(config);
  keen.set_visited({pose_at(45, 3)});
  EXPECT_TRUE(next(keen, map, pose_at(45, 3)));
  config.least_area_m2 = 0.6;
  Explorer lazy(config);
  lazy.set_visited({pose_at(5, 3)});
  EXPECT_FALSE(next(lazy, map, pose_at(5, 3)));
}

TEST(Explorer, TheFirstOfAShortTourComesNextAndNotTheNearest) {
  // The opening above is 3.5 m from the robot, the left end 5 m, the right end 9 m: starting with
  // the nearest, it would return along the whole corridor.
  std::vector<std::string> lines(7, "?" + std::string(54, '.') + "?");
  lines[0] = std::string(56, '?');
  lines[1] = std::string(33, '#') + "....." + std::string(18, '#');
  lines[6] = std::string(56, '#');
  const planning::HybridMap map = drawn_map(lines);
  ExplorerConfig config = small();
  config.least_area_m2 = 0.05;
  config.worth_m_per_m2 = 1000.0;
  Explorer explorer(config);
  explorer.set_visited({pose_at(20, 2)});
  const auto first = next(explorer, map, pose_at(20, 2));
  ASSERT_TRUE(first);
  EXPECT_LT(first->position_m.x(), explored_at(3, 0).x());
  config.tour = 1;
  Explorer greedy(config);
  greedy.set_visited({pose_at(20, 2)});
  const auto nearest = next(greedy, map, pose_at(20, 2));
  ASSERT_TRUE(nearest);
  EXPECT_NEAR(nearest->position_m.x(), explored_at(35, 0).x(), 0.6);
  EXPECT_LT(nearest->distance_m, first->distance_m);
}

TEST(Explorer, AnEntranceThatNoiseHasNarrowedIsLookedAtLast) {
  const std::vector<std::string> lines = {
      "###########################", "#.........#...............#", "#.........#...............#",
      "#.........................#", "#.........................#", "#.........................#",
      "#.........#...............#", "#.........#...............#", "###########################",
  };
  std::vector<std::string> filled = lines;
  filled[4][10] = '#';
  const planning::HybridMap map = drawn_map(filled);
  ASSERT_EQ(map.zones().zones.size(), 2U);
  Explorer explorer(small());
  explorer.set_visited({pose_at(4, 4)});
  const auto target = next(explorer, map, pose_at(4, 4));
  ASSERT_TRUE(target);
  EXPECT_EQ(target->kind, TargetKind::kBlocked);
  EXPECT_GT(target->position_m.x(), explored_at(10, 4).x());
  EXPECT_LT(target->T_map_view.x_m, explored_at(10, 4).x());
  EXPECT_TRUE(explorer.open(*target, map));
  EXPECT_FALSE(explorer.open(*target, drawn_map(lines)));
  // Unknown area elsewhere comes first.
  filled[4][0] = filled[3][0] = filled[5][0] = '?';
  ExplorerConfig config = small();
  config.least_area_m2 = 0.01;
  config.least_gap_m = kExplored_m;
  Explorer other(config);
  other.set_visited({pose_at(4, 4)});
  const auto gap = next(other, drawn_map(filled), pose_at(4, 4));
  ASSERT_TRUE(gap);
  EXPECT_EQ(gap->kind, TargetKind::kGap);
  // A wall cannot be passed.
  std::vector<std::string> closed = lines;
  for (std::string& line : closed) line[10] = '#';
  EXPECT_FALSE(next(explorer, drawn_map(closed), pose_at(4, 4)));
  explorer.give_up(*target);
  EXPECT_FALSE(next(explorer, map, pose_at(4, 4)));
}

TEST(Explorer, WhatWasPutOffComesAgainOnce) {
  const planning::HybridMap map = drawn_map(kOpenRight);
  Explorer explorer(small());
  explorer.set_visited({pose_at(3, 3)});
  EXPECT_FALSE(explorer.resume());
  std::size_t put_off = 0;
  for (int round = 0; round < 2; ++round) {
    while (const auto target = next(explorer, map, pose_at(3, 3))) {
      explorer.put_off(*target);
      ASSERT_LT(++put_off, 100U);
    }
    EXPECT_GT(put_off, 0U);
    EXPECT_EQ(explorer.resume(), round == 0);
  }
  EXPECT_GT(explorer.given_up(), 0U);
}

TEST(Explorer, ARobotOffTheMapGoesNowhere) {
  Explorer explorer(small());
  EXPECT_FALSE(next(explorer, drawn_map(kOpenRight), {-50.0, 3.0, 0.0}));
}

TEST(Explorer, BadSettingsAreNamed) {
  ExplorerConfig config;
  config.view_m = 0.2;
  try {
    const Explorer explorer(config);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("key 'explorer.view_m' = '0.2': expected at least "
                                        "explorer.approach_m = 1"));
  }
}

}  // namespace
}  // namespace topogeo::navigation
