// A robot without inertia on a floor drawn in text, which sees all cells in plain sight: the tour
// leads it everywhere.
#include "topogeo/navigation/exploration_tour.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "topogeo/planning/motion_primitives.hpp"

#include "planning/floors.hpp"

namespace topogeo::navigation {
namespace {

using planning::Cell;
using planning::CellState;
using planning::OccupancyGrid;

constexpr double kToured_m = 0.25;
constexpr std::int64_t kTourStep_ns = 200'000'000;

// clang-format off
const std::vector<std::string> kFloor = {
    "########################################",
    "#...........#...........#..............#",
    "#...........#...........#..............#",
    "#...........#...........#..............#",
    "#...........#...........#......##......#",
    "#...........#...........#......##......#",
    "#...........#...........#..............#",
    "######...########...########...#########",
    "#......................................#",
    "#......................................#",
    "#......................................#",
    "#......................................#",
    "###########...####################....##",
    "#...................#..................#",
    "#...................#..................#",
    "#...................#..................#",
    "#...................#....########......#",
    "#...................#....########......#",
    "#...................#..................#",
    "#...................#..................#",
    "#...................#..................#",
    "########################################",
};
// clang-format on

class TextRobot {
 public:
  TextRobot() : truth_(planning::grid_of_text(kFloor, kToured_m)), known_(truth_.frame()) {
    look();
  }

  /// Drives toward the goal by a step of the planned route; returns a navigator's status.
  NavigatorStatus step(const std::optional<TourGoal>& goal) {
    if (goal) {
      goal_ = goal;
      status_.state = NavigatorState::kDriving;
      status_.goal_id = goal->goal_id;
    }
    status_.T_map_robot = T_map_robot_;
    if (goal_ && status_.state == NavigatorState::kDriving) drive();
    return status_;
  }

  [[nodiscard]] ExploredMap map() {
    ExploredMap map;
    map.version = ++version_;
    map.graph = std::make_shared<const topomap::GlobalMap>();
    planning::InflationConfig inflation;
    inflation.forbidden_cells = 1.0;
    planning::FreeSpace space(known_, inflation);
    planning::ZoneConfig zones;
    zones.passage_half_width_m = 0.7;
    planning::ZoneMap cut = planning::zones_by_width(space, zones);
    map.map = std::make_shared<const planning::HybridMap>(std::move(space), std::move(cut));
    map.T_map_stops = stops_;
    map_ = map.map;
    return map;
  }

  /// Number of free cells that the robot does not know.
  [[nodiscard]] std::size_t unknown() const {
    std::size_t count = 0;
    const auto& frame = truth_.frame();
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const Cell cell = frame.cell_at(i);
      if (truth_.at(cell) == CellState::kFree && known_.at(cell) == CellState::kUnknown) {
        ++count;
      }
    }
    return count;
  }

  bool refuses = false;
  int refusals = 0;  // for the next goals
  std::size_t drives = 0;

 private:
  void drive() {
    if (refuses || refusals > 0) {
      if (refusals > 0) --refusals;
      status_.state = NavigatorState::kStopped;
      status_.reason = HaltReason::kNoRoute;
      return;
    }
    const planning::HybridRoute route = planning::plan_on_grid(
        map_->space(), T_map_robot_.position_m(), goal_->T_map_goal.position_m());
    if (!route.found() || route.points_m.size() < 2 || route.length_m < 0.05) {
      T_map_robot_ = goal_->T_map_goal;
      status_.state = NavigatorState::kArrived;
      status_.rest_m = 0.0;
    } else {
      const Eigen::Vector2d ahead_m = route.points_m[1] - route.points_m[0];
      const double step_m = std::min(0.5, ahead_m.norm());
      const Eigen::Vector2d to_m = route.points_m[0] + step_m / ahead_m.norm() * ahead_m;
      T_map_robot_ = {to_m.x(), to_m.y(), std::atan2(ahead_m.y(), ahead_m.x())};
      status_.rest_m = route.length_m - step_m;
      ++drives;
    }
    look();
  }

  void look() {
    stops_.push_back(T_map_robot_);
    const auto& frame = truth_.frame();
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const Cell cell = frame.cell_at(i);
      if (known_.at(cell) == CellState::kUnknown && in_sight(cell))
        known_.set(cell, truth_.at(cell));
    }
  }

  [[nodiscard]] bool in_sight(const Cell& cell) const {
    const auto& frame = truth_.frame();
    const Eigen::Vector2d from_m = T_map_robot_.position_m();
    const Eigen::Vector2d to_m = frame.center_m(cell);
    const double length_m = (to_m - from_m).norm();
    if (length_m > 5.0) return false;
    for (double along_m = 0.0; along_m < length_m; along_m += 0.05) {
      const auto at = frame.cell_of(from_m + along_m / length_m * (to_m - from_m));
      if (at && !(*at == cell) && truth_.at(*at) == CellState::kOccupied) return false;
    }
    return true;
  }

  OccupancyGrid truth_;
  OccupancyGrid known_;
  std::shared_ptr<const planning::HybridMap> map_;
  geometry::Pose2 T_map_robot_{0.25 * 5.5, 0.25 * 10.5, 0.0};
  std::vector<geometry::Pose2> stops_;
  std::optional<TourGoal> goal_;
  NavigatorStatus status_;
  std::uint64_t version_ = 0;
};

TourConfig config() {
  TourConfig config;
  config.explorer.sure_m = 0.2;
  config.explorer.least_gap_m = kToured_m;  // coarse cells
  config.explorer.least_area_m2 = 0.01;
  config.explorer.worth_m_per_m2 = 10000.0;
  return config;
}

TEST(ExplorationTour, SeesAllThatCanBeReachedAndEnds) {
  TextRobot robot;
  ExplorationTour tour(config());
  std::optional<TourGoal> goal;
  std::uint64_t last_goal = 0;
  int steps = 0;
  for (; steps < 4000 && !tour.done(); ++steps) {
    tour.set_map(robot.map());
    goal = tour.step(robot.step(goal), steps * kTourStep_ns);
    if (!goal) continue;
    EXPECT_GT(goal->goal_id, last_goal);
    last_goal = goal->goal_id;
  }
  EXPECT_TRUE(tour.done()) << tour.message();
  EXPECT_EQ(robot.unknown(), 0U);
  EXPECT_GT(tour.targets(), 4U);
  EXPECT_FALSE(tour.step(robot.step({}), steps * kTourStep_ns));
}

TEST(ExplorationTour, EndsWhenTheNavigatorGetsNowhere) {
  TextRobot robot;
  robot.refuses = true;
  ExplorationTour tour(config());
  std::optional<TourGoal> goal;
  for (int i = 0; i < 4000 && !tour.done(); ++i) {
    tour.set_map(robot.map());
    goal = tour.step(robot.step(goal), i * kTourStep_ns);
  }
  EXPECT_TRUE(tour.done());
  EXPECT_GT(tour.given_up(), 0U);
  EXPECT_EQ(robot.drives, 0U);
}

TEST(ExplorationTour, WhereThereWasNoPathAtFirstItGoesLater) {
  TextRobot robot;
  robot.refusals = 12;
  ExplorationTour tour(config());
  std::optional<TourGoal> goal;
  for (int i = 0; i < 4000 && !tour.done(); ++i) {
    tour.set_map(robot.map());
    goal = tour.step(robot.step(goal), i * kTourStep_ns);
  }
  EXPECT_TRUE(tour.done());
  EXPECT_EQ(robot.refusals, 0);
  EXPECT_EQ(robot.unknown(), 0U);
}

TourConfig impatient() {
  TourConfig impatient = config();
  impatient.patience_s = 5.0;
  return impatient;
}

TEST(ExplorationTour, ATargetWithoutProgressIsGivenUp) {
  TextRobot robot;
  ExplorationTour tour(impatient());
  tour.set_map(robot.map());
  const auto goal = tour.step(robot.step({}), 0);
  ASSERT_TRUE(goal);
  NavigatorStatus blocked;
  blocked.state = NavigatorState::kBlocked;
  blocked.goal_id = goal->goal_id;
  blocked.rest_m = 3.0;
  blocked.T_map_robot = geometry::Pose2{0.25 * 5.5, 0.25 * 10.5, 0.0};
  EXPECT_FALSE(tour.step(blocked, 4 * kTourStep_ns));
  EXPECT_EQ(tour.given_up(), 0U);
  const auto other = tour.step(blocked, 60 * kTourStep_ns);
  EXPECT_EQ(tour.given_up(), 1U);
  ASSERT_TRUE(other);
  EXPECT_GT(other->goal_id, goal->goal_id);
}

// A navigator that starts just then does not get the goal.
TEST(ExplorationTour, AGoalThatIsNotReceivedIsGivenAnew) {
  TextRobot robot;
  ExplorationTour tour(impatient());
  tour.set_map(robot.map());
  const auto goal = tour.step(robot.step({}), 0);
  ASSERT_TRUE(goal);
  NavigatorStatus idle;
  idle.T_map_robot = geometry::Pose2{0.25 * 5.5, 0.25 * 10.5, 0.0};
  EXPECT_FALSE(tour.step(idle, 4 * kTourStep_ns));
  tour.set_map(robot.map());
  const auto other = tour.step(idle, 60 * kTourStep_ns);
  ASSERT_TRUE(other);
  EXPECT_GT(other->goal_id, goal->goal_id);
  EXPECT_EQ(tour.given_up(), 0U);
  // Another client has replaced a goal that was received: it is not taken away from that client.
  NavigatorStatus drives = idle;
  drives.state = NavigatorState::kDriving;
  drives.goal_id = other->goal_id;
  EXPECT_FALSE(tour.step(drives, 61 * kTourStep_ns));
  EXPECT_FALSE(tour.step(idle, 200 * kTourStep_ns));
}

TEST(ExplorationTour, WaitsForMapAndPose) {
  ExplorationTour tour(config());
  EXPECT_FALSE(tour.step({}, 0));
  TextRobot robot;
  tour.set_map(robot.map());
  EXPECT_FALSE(tour.step({}, kTourStep_ns));  // without a pose
  EXPECT_FALSE(tour.done());
  EXPECT_TRUE(tour.step(robot.step({}), 2 * kTourStep_ns));
}

TEST(ExplorationTour, FollowsWhatHasChangedAlone) {
  const auto map = TextRobot().map().map;
  int asked = 0;
  const auto stops = [&] {
    ++asked;
    return std::vector<geometry::Pose2>{};
  };
  ExplorationTour tour;
  tour.follow(nullptr, nullptr, stops);
  EXPECT_EQ(tour.message(), "waits for a map");
  tour.follow(nullptr, map, stops);
  EXPECT_EQ(tour.message(), "looks for a target");
  tour.follow(nullptr, map, stops);
  EXPECT_EQ(asked, 1);
  tour.follow(std::make_shared<const topomap::GlobalMap>(), map, stops);
  EXPECT_EQ(asked, 2) << "another graph";
}

}  // namespace
}  // namespace topogeo::navigation
