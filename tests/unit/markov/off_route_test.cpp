// A robot some cells off its route notices it and returns, the purpose of Markov localization. The
// readings come from the walls as lines, not from the localizer's cells.
#include <numbers>

#include <gtest/gtest.h>

#include "topogeo/markov/markov_localizer.hpp"

#include "drawn_map.hpp"

namespace topogeo::markov {
namespace {

geometry::Pose2 after(const geometry::Pose2& start, const Move& move) {
  switch (move.kind) {
    case MoveKind::kAdvance:
      return start * geometry::Pose2{move.amount, 0.0, 0.0};
    case MoveKind::kTurnLeft:
      return start * geometry::Pose2{0.0, 0.0, move.amount};
    case MoveKind::kTurnRight:
      return start * geometry::Pose2{0.0, 0.0, -move.amount};
  }
  return start;
}

struct Drive {
  test::Room room{60, 20};  // a corridor of 6 x 2 m
  std::vector<RangeSensor> ring = test::macondo_ring();
  MarkovLocalizer localizer{{}, room.cells(), ring};

  /// Starts with the robot 2.5 m along the corridor from its base station, 2.3 m before its end.
  Drive() {
    const geometry::Pose2 base{1.35, 1.15, 0.0};
    localizer.initialize(base, room.measured(base, ring));
    localizer.move({MoveKind::kAdvance, 2.5});
  }

  [[nodiscard]] geometry::Pose2 off_route(Cell cells) const {
    geometry::Pose2 truth = localizer.expected();
    truth.x_m += 0.1 * cells.x;
    truth.y_m += 0.1 * cells.y;
    return truth;
  }
};

const std::vector<Cell> kOffsets = {{0, 0}, {1, 0},  {-1, 0}, {0, 1},  {0, -1}, {2, 1}, {-2, -1},
                                    {3, 0}, {-3, 2}, {1, -3}, {4, -2}, {0, 4},  {5, 3}};

TEST(Relocalization, AnOffsetInACorridorIsFound) {
  for (const Cell offset : kOffsets) {
    Drive run;
    const PerceptionReport report =
        run.localizer.perceive(run.room.measured(run.off_route(offset), run.ring));
    EXPECT_EQ(report.match.reliability, 1.0);
    const std::optional<Estimate> estimate = run.localizer.estimate();
    ASSERT_TRUE(estimate);
    EXPECT_EQ(estimate->offset, offset) << "off by " << offset.x << ", " << offset.y << "; found "
                                        << estimate->offset.x << ", " << estimate->offset.y;
  }
}

TEST(Relocalization, AlsoWithReadingsThatAreCentimetresOff) {
  const float error_m[] = {0.02F, -0.02F, -0.015F, 0.02F, 0.01F, -0.02F};
  for (const Cell offset : kOffsets) {
    Drive run;
    std::vector<float> ranges_m = run.room.measured(run.off_route(offset), run.ring);
    for (std::size_t i = 0; i < ranges_m.size(); ++i) ranges_m[i] += error_m[i];
    run.localizer.perceive(ranges_m);
    EXPECT_EQ(run.localizer.estimate()->offset, offset) << offset.x << ", " << offset.y;
  }
}

TEST(Relocalization, AlsoWithOneSonarBlockedByAPerson) {
  for (const Cell offset : kOffsets) {
    Drive run;
    std::vector<float> ranges_m = run.room.measured(run.off_route(offset), run.ring);
    ranges_m[3] = 0.2F;
    run.localizer.perceive(ranges_m);
    EXPECT_EQ(run.localizer.estimate()->offset, offset) << offset.x << ", " << offset.y;
  }
}

TEST(Relocalization, TheMovesBringTheRobotBackToTheRoute) {
  for (const Cell offset : kOffsets) {
    Drive run;
    geometry::Pose2 truth = run.off_route(offset);
    const geometry::Pose2 route = run.localizer.expected();
    run.localizer.perceive(run.room.measured(truth, run.ring));
    const std::optional<ReturnMoves> back = run.localizer.relocalization_moves();
    ASSERT_TRUE(back);
    EXPECT_FALSE(back->blocked);
    EXPECT_EQ(back->moves.empty(), offset == Cell{});
    run.localizer.accept_estimate();
    for (const Move& move : back->moves) {
      truth = after(truth, move);
      run.localizer.move(move);
    }
    EXPECT_NEAR(truth.x_m, route.x_m, 1e-6) << offset.x << ", " << offset.y;
    EXPECT_NEAR(truth.y_m, route.y_m, 1e-6);
    EXPECT_NEAR(geometry::wrap_angle(truth.theta_rad - route.theta_rad), 0.0, 1e-9);
    EXPECT_NEAR(run.localizer.expected().x_m, route.x_m, 1e-6);
    EXPECT_NEAR(run.localizer.expected().y_m, route.y_m, 1e-6);
    run.localizer.perceive(run.room.measured(truth, run.ring));
    EXPECT_EQ(run.localizer.estimate()->offset, (Cell{0, 0})) << offset.x << ", " << offset.y;
  }
}

TEST(Relocalization, TurnAdvanceTurn) {
  Drive run;
  // Two cells to the left of the route: turn right, advance, turn left.
  run.localizer.perceive(run.room.measured(run.off_route({0, 2}), run.ring));
  const std::optional<ReturnMoves> back = run.localizer.relocalization_moves();
  ASSERT_TRUE(back);
  ASSERT_EQ(back->moves.size(), 3U);
  EXPECT_EQ(back->moves[0].kind, MoveKind::kTurnRight);
  EXPECT_NEAR(back->moves[0].amount, test::kQuarter_rad, 1e-9);
  EXPECT_EQ(back->moves[1].kind, MoveKind::kAdvance);
  EXPECT_NEAR(back->moves[1].amount, 0.2, 1e-9);
  EXPECT_EQ(back->moves[2].kind, MoveKind::kTurnLeft);
  EXPECT_NEAR(back->moves[2].amount, test::kQuarter_rad, 1e-9);
}

TEST(Relocalization, AnObstacleOnTheReturnPathIsReported) {
  const ObstacleCells map = test::drawn({"#########",  //
                                         "#.......#",  //
                                         "#.......#",  //
                                         "#...#...#",  //
                                         "#.......#",  //
                                         "#.......#",  //
                                         "#########"});
  MarkovLocalizer localizer{{}, map, test::macondo_ring()};
  localizer.initialize({0.25, 0.35, 0.0}, std::vector<float>(6, scan::Scan::kNoReturn));
  EXPECT_TRUE(localizer.relocalization_moves({0.65, 0.35, 0.0})->blocked);
  EXPECT_FALSE(localizer.relocalization_moves({0.25, 0.55, 0.0})->blocked);
  EXPECT_TRUE(localizer.relocalization_moves({0.25, 0.95, 0.0})->blocked);  // outside the map
}

TEST(Relocalization, AcceptingTheEstimateLeavesProbabilitiesInTheirPlaces) {
  Drive run;
  run.localizer.perceive(run.room.measured(run.off_route({2, -1}), run.ring));
  const Estimate before = *run.localizer.estimate();
  run.localizer.accept_estimate();
  const Estimate accepted = *run.localizer.estimate();
  EXPECT_EQ(accepted.cell, before.cell);
  EXPECT_EQ(accepted.offset, (Cell{0, 0}));
  EXPECT_NEAR(accepted.probability, before.probability, 0.01);  // the rim of the window is lost
  EXPECT_NEAR(run.localizer.expected().x_m, before.T_map_robot.x_m, 1e-12);
}

TEST(Relocalization, ALaserDoesTheSame) {
  const test::Room room{60, 20};
  const geometry::Pose2 T_robot_laser{0.1, 0.0, 0.0};
  scan::Scan scan;
  scan.angle_min_rad = -test::kQuarter_rad;
  scan.angle_step_rad = test::kQuarter_rad / 90.0;
  scan.ranges_m.assign(181, scan::Scan::kNoReturn);
  const std::vector<RangeSensor> beams = laser_sensors(T_robot_laser, scan, 20);
  ASSERT_EQ(beams.size(), 10U);
  EXPECT_NEAR(beams[9].T_robot_sensor.theta_rad, test::kQuarter_rad, 1e-9);
  EXPECT_EQ(laser_ranges(scan, 20).size(), 10U);
  EXPECT_THROW(laser_ranges(scan, 0), std::invalid_argument);
  for (const Cell offset : kOffsets) {
    MarkovLocalizer localizer{{}, room.cells(), beams};
    localizer.initialize({1.35, 1.15, 0.0}, laser_ranges(scan, 20));
    localizer.move({MoveKind::kAdvance, 2.5});
    geometry::Pose2 truth = localizer.expected();
    truth.x_m += 0.1 * offset.x;
    truth.y_m += 0.1 * offset.y;
    scan::Scan seen = scan;
    for (std::size_t i = 0; i < seen.ranges_m.size(); ++i) {
      const double bearing_rad = seen.angle_min_rad + static_cast<double>(i) * seen.angle_step_rad;
      seen.ranges_m[i] =
          static_cast<float>(room.ray_m((truth * T_robot_laser).position_m(), bearing_rad));
    }
    localizer.perceive(laser_ranges(seen, 20));
    EXPECT_EQ(localizer.estimate()->offset, offset) << offset.x << ", " << offset.y;
  }
}

}  // namespace
}  // namespace topogeo::markov
