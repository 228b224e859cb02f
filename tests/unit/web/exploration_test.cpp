// A corridor whose right half is still unknown.
#include "orders/exploration.hpp"

#include <gtest/gtest.h>

#include "planning/floors.hpp"

namespace topogeo::web {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPeriod{200};

const std::vector<std::string> kHalfKnown = {
    "##################????", "#.................????", "#.................????",
    "#.................????", "#.................????", "#.................????",
    "##################????",
};
const std::vector<std::string> kAllKnown = {
    "##################", "#................#", "#................#", "#................#",
    "#................#", "#................#", "##################",
};

ExploredFloor floor_of(const std::vector<std::string>& text) {
  planning::InflationConfig inflation;
  inflation.forbidden_cells = 1.0;
  planning::FreeSpace space(planning::grid_of_text(text, 0.25), inflation);
  planning::ZoneConfig config;
  config.min_area_m2 = 0.2;
  planning::ZoneMap zones = planning::drawn_zones(space, {}, config);
  ExploredFloor floor;
  floor.graph = std::make_shared<const topomap::GlobalMap>();
  floor.map = std::make_shared<const planning::HybridMap>(std::move(space), std::move(zones));
  floor.T_map_stops = [] { return std::vector<geometry::Pose2>{{1.0, 0.75, 0.0}}; };
  return floor;
}

navigation::TourConfig small() {
  navigation::TourConfig config;
  config.explorer.sure_m = 0.2;
  config.explorer.least_gap_m = 0.5;
  config.explorer.least_room_m2 = 0.5;
  return config;
}

navigation::NavigatorStatus standing() {
  navigation::NavigatorStatus status;
  status.T_map_robot = geometry::Pose2{1.0, 0.75, 0.0};
  return status;
}

/// Steps until there is a goal, for at most a minute of the robot's time.
std::optional<ExplorationGoal> first_goal(Exploration& exploration, const ExploredFloor& floor) {
  for (int i = 0; i < 300; ++i) {
    if (auto goal = exploration.step(floor, standing(), false, kPeriod)) return goal;
  }
  return std::nullopt;
}

TEST(Exploration, GivesGoalsOnlyWhileItRuns) {
  Exploration exploration;
  const ExploredFloor floor = floor_of(kHalfKnown);
  EXPECT_FALSE(first_goal(exploration, floor));
  EXPECT_FALSE(exploration.done());
  EXPECT_EQ(exploration.summary(), "");
  exploration.start(small());
  EXPECT_TRUE(exploration.running());
  const auto goal = first_goal(exploration, floor);
  ASSERT_TRUE(goal);
  EXPECT_GT(goal->T_map_goal.x_m, 1.5) << "toward what is not known";
  EXPECT_NE(goal->text.find("not mapped yet"), std::string::npos);
  EXPECT_NE(exploration.summary().find("1 targets"), std::string::npos) << exploration.summary();
  exploration.stop();
  EXPECT_FALSE(exploration.running());
  EXPECT_FALSE(first_goal(exploration, floor));
}

TEST(Exploration, WithoutAFloorItWaits) {
  Exploration exploration;
  exploration.start(small());
  EXPECT_FALSE(first_goal(exploration, {}));
  EXPECT_FALSE(exploration.done());
  EXPECT_TRUE(first_goal(exploration, floor_of(kHalfKnown)));
}

TEST(Exploration, EndsWhenNothingIsLeft) {
  Exploration exploration;
  exploration.start(small());
  EXPECT_FALSE(first_goal(exploration, floor_of(kAllKnown)));
  EXPECT_TRUE(exploration.done());
  exploration.start(small());
  EXPECT_FALSE(exploration.done()) << "from the beginning";
}

// Targets have a time limit, which must not expire while an operator has paused the goal.
TEST(Exploration, NoTimePassesWhileItsGoalIsPaused) {
  const ExploredFloor floor = floor_of(kHalfKnown);
  const auto given_up_after = [&](navigation::HaltReason reason) {
    Exploration exploration;
    exploration.start(small());
    EXPECT_TRUE(first_goal(exploration, floor));
    navigation::NavigatorStatus status = standing();
    status.state = navigation::NavigatorState::kStopped;
    status.reason = reason;
    for (int i = 0; i < 5 * 600; ++i) {
      static_cast<void>(exploration.step(floor, status, true, kPeriod));
    }
    return exploration.done();
  };
  EXPECT_TRUE(given_up_after(navigation::HaltReason::kNoRoute));
  EXPECT_FALSE(given_up_after(navigation::HaltReason::kPaused));
}

}  // namespace
}  // namespace topogeo::web
