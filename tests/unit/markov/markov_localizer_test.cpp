#include "topogeo/markov/markov_localizer.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drawn_map.hpp"

namespace topogeo::markov {
namespace {

const std::vector<float> kNothing(6, scan::Scan::kNoReturn);

void expect_probabilities(const BeliefGrid& belief) {
  double sum = 0.0;
  for (const double probability : belief.current()) {
    ASSERT_TRUE(std::isfinite(probability));
    ASSERT_GE(probability, 0.0);
    sum += probability;
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
}

TEST(MarkovLocalizer, BeginsAtTheBaseStationWithOnePerceptualUpdate) {
  const test::Room room{30, 20};
  MarkovLocalizer localizer{{}, room.cells(), test::macondo_ring()};
  const geometry::Pose2 base{1.05, 1.15, 0.0};
  const PerceptionReport report =
      localizer.initialize(base, room.measured(base, test::macondo_ring()));
  EXPECT_TRUE(report.possible);
  EXPECT_EQ(report.match.compared, 6);
  EXPECT_EQ(report.match.reliability, 1.0);  // everything is within 2.5 m
  EXPECT_DOUBLE_EQ(report.weight, 0.6);
  expect_probabilities(localizer.belief());
  // 1 - 0.6 from the base station itself, the rest from the sensors.
  EXPECT_GT(localizer.belief().at({0, 0}), 0.4);
  EXPECT_GT(localizer.belief().at({1, 0}), 0.0);
  EXPECT_GT(localizer.belief().at({0, 0}), localizer.belief().at({1, 0}) + 0.4);
  EXPECT_EQ(localizer.estimate()->offset, (Cell{0, 0}));
}

TEST(MarkovLocalizer, WithoutReadingsTheBaseStationIsCertain) {
  const test::Room room{30, 20};
  MarkovLocalizer localizer{{}, room.cells(), test::macondo_ring()};
  const PerceptionReport report = localizer.initialize({1.05, 1.15, 0.0}, kNothing);
  EXPECT_TRUE(report.possible);
  EXPECT_EQ(report.weight, 0.0);
  EXPECT_EQ(report.reason, "no sensor has a reading");
  const std::optional<Estimate> estimate = localizer.estimate();
  ASSERT_TRUE(estimate);
  EXPECT_EQ(estimate->probability, 1.0);
  EXPECT_EQ(estimate->entropy, 0.0);
  EXPECT_EQ(estimate->spread_m, 0.0);
  EXPECT_EQ(estimate->cell, (Cell{10, 11}));
}

TEST(MarkovLocalizer, TheExpectedPoseAndTheWindowFollowTheMoves) {
  MarkovLocalizer localizer{{}, test::open_space(100, 100), test::macondo_ring()};
  localizer.initialize({5.05, 5.05, 0.0}, kNothing);
  localizer.move({MoveKind::kAdvance, 0.5});
  EXPECT_EQ(localizer.belief().centre(), (Cell{55, 50}));
  localizer.move({MoveKind::kTurnLeft, test::kQuarter_rad});
  localizer.move({MoveKind::kAdvance, 1.0});
  EXPECT_EQ(localizer.belief().centre(), (Cell{55, 60}));
  localizer.move({MoveKind::kTurnRight, 2 * test::kQuarter_rad});
  localizer.move({MoveKind::kAdvance, -0.3});
  EXPECT_EQ(localizer.belief().centre(), (Cell{55, 63}));
  EXPECT_NEAR(localizer.expected().x_m, 5.55, 1e-9);
  EXPECT_NEAR(localizer.expected().y_m, 6.35, 1e-9);
  EXPECT_NEAR(localizer.expected().theta_rad, -test::kQuarter_rad, 1e-9);
  expect_probabilities(localizer.belief());
}

TEST(MarkovLocalizer, AnAdvanceOfACellIsTheWorkedExampleNormalized) {
  MarkovLocalizer localizer{{}, test::open_space(100, 100), test::macondo_ring()};
  localizer.initialize({5.05, 5.05, test::kQuarter_rad}, kNothing);
  const MovementReport report = localizer.move({MoveKind::kAdvance, 0.1});
  constexpr double kSum = .7929 + 3 * .0625 + 2 * .0078;
  EXPECT_NEAR(report.kept_share, kSum, 1e-12);
  EXPECT_NEAR(localizer.belief().at({0, 0}), .7929 / kSum, 1e-12);
  EXPECT_NEAR(localizer.belief().at({0, 1}), .0625 / kSum, 1e-12);
  EXPECT_NEAR(localizer.belief().at({-1, 1}), .0078 / kSum, 1e-12);
  EXPECT_EQ(localizer.belief().at({0, -1}), 0.0);
}

TEST(MarkovLocalizer, BackwardsTheMatrixIsTurnedWithTheMotion) {
  MarkovLocalizer localizer{{}, test::open_space(100, 100), test::macondo_ring()};
  localizer.initialize({5.05, 5.05, 0.0}, kNothing);
  localizer.move({MoveKind::kAdvance, -0.1});
  EXPECT_GT(localizer.belief().at({-1, 0}), 0.06);
  EXPECT_EQ(localizer.belief().at({1, 0}), 0.0);
}

TEST(MarkovLocalizer, EachPrimitiveHasItsMatrix) {
  MarkovConfig config;
  config.transition.advance = {1, 3, {0.0, 0.0, 1.0}};  // ahead
  config.transition.left = {3, 1, {1.0, 0.0, 0.0}};     // to the left
  config.transition.right = {3, 1, {0.0, 0.0, 1.0}};    // to the right
  const auto after = [&](const Move& move) {
    MarkovLocalizer localizer{config, test::open_space(100, 100), test::macondo_ring()};
    localizer.initialize({5.05, 5.05, 0.0}, kNothing);
    localizer.move(move);
    return localizer.estimate()->offset;
  };
  EXPECT_EQ(after({MoveKind::kAdvance, 0.1}), (Cell{1, 0}));
  EXPECT_EQ(after({MoveKind::kTurnLeft, test::kQuarter_rad}), (Cell{0, 1}));
  EXPECT_EQ(after({MoveKind::kTurnRight, test::kQuarter_rad}), (Cell{0, -1}));
  EXPECT_EQ(after({MoveKind::kTurnLeft, 3 * test::kQuarter_rad}), (Cell{0, 3}));
}

TEST(MarkovLocalizer, EntropyAndSpreadOfThreeEqualCells) {
  MarkovConfig config;
  config.transition.advance = {1, 3, {0.25, 0.25, 0.25}};
  MarkovLocalizer localizer{config, test::open_space(100, 100), test::macondo_ring()};
  localizer.initialize({5.05, 5.05, 0.0}, kNothing);
  localizer.move({MoveKind::kAdvance, 0.1});
  const std::optional<Estimate> estimate = localizer.estimate();
  ASSERT_TRUE(estimate);
  EXPECT_EQ(estimate->offset, (Cell{0, 0}));  // nearest to the expected cell among equals
  EXPECT_NEAR(estimate->probability, 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(estimate->entropy, std::log(3.0), 1e-12);
  EXPECT_NEAR(estimate->spread_m, 0.1 * std::sqrt(2.0 / 3.0), 1e-12);
}

TEST(MarkovLocalizer, AnAdvanceInPiecesIsTheSameAdvance) {
  const auto after = [](const std::vector<double>& lengths_m) {
    MarkovLocalizer localizer{{}, test::open_space(100, 100), test::macondo_ring()};
    localizer.initialize({5.05, 5.05, 0.7}, kNothing);
    for (const double length_m : lengths_m) localizer.move({MoveKind::kAdvance, length_m});
    const std::span<const double> state = localizer.belief().current();
    return std::vector<double>(state.begin(), state.end());
  };
  const std::vector<double> whole = after({0.6});
  const std::vector<double> pieces = after({0.1, 0.2, 0.3});
  for (std::size_t i = 0; i < whole.size(); ++i) ASSERT_NEAR(whole[i], pieces[i], 1e-12);
}

TEST(MarkovLocalizer, UncertaintyGrowsWithTheDistance) {
  MarkovLocalizer localizer{{}, test::open_space(200, 200), test::macondo_ring()};
  localizer.initialize({5.05, 5.05, 0.3}, kNothing);
  double entropy = 0.0;
  double spread_m = 0.0;
  for (int i = 0; i < 20; ++i) {
    localizer.move(i % 5 == 4 ? Move{MoveKind::kTurnLeft, 0.2} : Move{MoveKind::kAdvance, 0.25});
    const std::optional<Estimate> estimate = localizer.estimate();
    ASSERT_TRUE(estimate);
    EXPECT_GT(estimate->entropy, entropy) << "move " << i;
    EXPECT_GT(estimate->spread_m, spread_m) << "move " << i;
    entropy = estimate->entropy;
    spread_m = estimate->spread_m;
  }
  expect_probabilities(localizer.belief());
}

TEST(MarkovLocalizer, OncePerPrimitiveIfTheStepIsZero) {
  MarkovConfig config;
  config.transition.advance_step_m = 0.0;
  MarkovLocalizer localizer{config, test::open_space(100, 100), test::macondo_ring()};
  localizer.initialize({5.05, 5.05, 0.0}, kNothing);
  const MovementReport report = localizer.move({MoveKind::kAdvance, 3.0});
  EXPECT_EQ(localizer.belief().centre(), (Cell{80, 50}));
  EXPECT_NEAR(localizer.belief().at({0, 0}), .7929 / report.kept_share, 1e-12);
}

TEST(MarkovLocalizer, ProbabilityDoesNotLeaveACorridor) {
  // Three cells wide: the walls on both sides keep zero however far the robot drives.
  const test::Room room{80, 3};
  MarkovLocalizer localizer{{}, room.cells(), test::macondo_ring()};
  localizer.initialize({0.55, 0.25, 0.0}, kNothing);
  const MovementReport report = localizer.move({MoveKind::kAdvance, 5.0});
  EXPECT_TRUE(report.possible);
  EXPECT_LT(report.kept_share, 0.996);
  for (int x = -10; x <= 10; ++x) {
    EXPECT_EQ(localizer.belief().at({x, 2}), 0.0);
    EXPECT_EQ(localizer.belief().at({x, -2}), 0.0);
  }
  expect_probabilities(localizer.belief());
}

TEST(MarkovLocalizer, WeightedSumOfBothModels) {
  const test::Room room{30, 20};
  const std::vector<RangeSensor> ring = test::macondo_ring();
  MarkovLocalizer localizer{{}, room.cells(), ring};
  const geometry::Pose2 base{1.05, 1.15, 0.0};
  localizer.initialize(base, kNothing);
  localizer.move({MoveKind::kAdvance, 0.5});
  const std::span<const double> state = localizer.belief().current();
  const std::vector<double> movement(state.begin(), state.end());
  std::vector<float> ranges_m = room.measured({1.65, 1.05, 0.0}, ring);
  ranges_m[1] = scan::Scan::kNoReturn;
  const PerceptionReport report = localizer.perceive(ranges_m);
  EXPECT_NEAR(report.weight, 0.6 * 5.0 / 6.0, 1e-12);
  SonarModel sonar{ring, {}};
  sonar.look_around(room.cells(), localizer.expected(), 21);
  std::vector<double> perceptual(movement.size());
  sonar.compare(ranges_m, perceptual);
  for (std::size_t i = 0; i < movement.size(); ++i) {
    ASSERT_NEAR(localizer.belief().current()[i],
                report.weight * perceptual[i] + (1.0 - report.weight) * movement[i], 1e-12);
  }
}

TEST(MarkovLocalizer, SonarsThatReadNothingChangeNothing) {
  const test::Room room{30, 20};
  MarkovLocalizer localizer{{}, room.cells(), test::macondo_ring()};
  localizer.initialize({1.05, 1.15, 0.0}, kNothing);
  localizer.move({MoveKind::kAdvance, 0.5});
  const std::span<const double> state = localizer.belief().current();
  const std::vector<double> before(state.begin(), state.end());
  const PerceptionReport report = localizer.perceive(kNothing);
  EXPECT_TRUE(report.possible);
  EXPECT_EQ(report.weight, 0.0);
  EXPECT_EQ(report.reason, "no sensor has a reading");
  for (std::size_t i = 0; i < before.size(); ++i) {
    ASSERT_EQ(localizer.belief().current()[i], before[i]);
  }
}

TEST(MarkovLocalizer, ARobotInAnImpossiblePlaceIsReported) {
  // Into the wall and on: no cell is left, nothing is NaN, and there is no estimate.
  const test::Room room{10, 10};
  MarkovLocalizer localizer{{}, room.cells(), test::macondo_ring()};
  localizer.initialize({0.85, 0.55, 0.0}, kNothing);
  const MovementReport moved = localizer.move({MoveKind::kAdvance, 3.0});
  EXPECT_FALSE(moved.possible);
  EXPECT_EQ(moved.kept_share, 0.0);
  EXPECT_THAT(moved.reason, testing::HasSubstr("every free cell of the window"));
  for (const double probability : localizer.belief().current()) EXPECT_EQ(probability, 0.0);
  EXPECT_FALSE(localizer.estimate());
  EXPECT_FALSE(localizer.relocalization_moves());
  localizer.accept_estimate();
  const PerceptionReport perceived = localizer.perceive(std::vector<float>(6, 1.0F));
  EXPECT_FALSE(perceived.possible);
  EXPECT_FALSE(perceived.reason.empty());
  EXPECT_FALSE(localizer.move({MoveKind::kTurnLeft, 1.0}).possible);
}

TEST(MarkovLocalizer, ReadingsCanBringARobotBackThatWasNowhere) {
  const test::Room room{20, 20};
  const std::vector<RangeSensor> ring = test::macondo_ring();
  MarkovLocalizer localizer{{}, room.cells(), ring};
  localizer.initialize({1.85, 1.05, 0.0}, kNothing);
  EXPECT_FALSE(localizer.move({MoveKind::kAdvance, 0.6}).possible);
  // The robot is in front of the wall, six cells short of its expected place.
  const PerceptionReport report = localizer.perceive(room.measured({1.85, 1.05, 0.0}, ring));
  ASSERT_TRUE(report.possible) << report.reason;
  EXPECT_GT(report.weight, 0.0);
  expect_probabilities(localizer.belief());
  EXPECT_EQ(localizer.estimate()->cell, (Cell{18, 10}));
}

TEST(MarkovLocalizer, ABaseStationInAWallOrOutsideIsReported) {
  const test::Room room{10, 10};
  MarkovLocalizer localizer{{}, room.cells(), test::macondo_ring()};
  const PerceptionReport in_wall = localizer.initialize({0.05, 0.55, 0.0}, kNothing);
  EXPECT_FALSE(in_wall.possible);
  EXPECT_EQ(in_wall.reason, "the base station is in cell (0, 5), which is an obstacle");
  const PerceptionReport outside = localizer.initialize({-3.05, 0.55, 0.0}, kNothing);
  EXPECT_FALSE(outside.possible);
  EXPECT_THAT(outside.reason, testing::HasSubstr("outside the map"));
  EXPECT_FALSE(localizer.estimate());
}

TEST(MarkovLocalizer, ADoorFoundShutTakesItsCells) {
  std::vector<std::string> lines(30, std::string(30, '.'));
  MarkovLocalizer localizer{{}, test::drawn(lines), test::macondo_ring()};
  localizer.initialize({1.55, 1.55, 0.0}, kNothing);
  localizer.move({MoveKind::kAdvance, 0.3});
  for (std::string& line : lines) line[19] = '#';
  const MovementReport report = localizer.set_map(test::drawn(lines));
  EXPECT_TRUE(report.possible);
  EXPECT_LT(report.kept_share, 1.0);
  for (int y = -10; y <= 10; ++y) EXPECT_EQ(localizer.belief().at({1, y}), 0.0);
  expect_probabilities(localizer.belief());
  EXPECT_FALSE(
      localizer.set_map(test::drawn(std::vector<std::string>(30, std::string(30, '#')))).possible);
  EXPECT_THROW(localizer.set_map(test::drawn(lines, 0.05)), std::invalid_argument);
}

TEST(MarkovLocalizer, OtherWindows) {
  const test::Room room{150, 150};
  for (const int size : {5, 63, 101}) {
    MarkovConfig config;
    config.window_cells = size;
    MarkovLocalizer localizer{config, room.cells(), test::macondo_ring()};
    const geometry::Pose2 base{2.05, 1.05, 0.0};
    localizer.initialize(base, room.measured(base, test::macondo_ring()));
    localizer.move({MoveKind::kAdvance, 1.0});
    localizer.perceive(room.measured({3.15, 1.05, 0.0}, test::macondo_ring()));
    expect_probabilities(localizer.belief());
  }
}

TEST(MarkovLocalizer, BadInputIsRefusedAndChangesNothing) {
  const test::Room room{30, 20};
  const std::vector<RangeSensor> ring = test::macondo_ring();
  MarkovLocalizer localizer{{}, room.cells(), ring};
  EXPECT_THROW(localizer.move({}), std::runtime_error);
  EXPECT_THROW(localizer.perceive(kNothing), std::runtime_error);
  EXPECT_FALSE(localizer.estimate());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(localizer.initialize({nan, 0.0, 0.0}, kNothing), std::invalid_argument);
  EXPECT_THROW(localizer.initialize({0.0, 1e9, 0.0}, kNothing), std::invalid_argument);
  localizer.initialize({1.05, 1.15, 0.0}, kNothing);
  localizer.move({MoveKind::kAdvance, 0.3});
  const std::span<const double> state = localizer.belief().current();
  const std::vector<double> before(state.begin(), state.end());
  EXPECT_THROW(localizer.move({MoveKind::kAdvance, nan}), std::invalid_argument);
  EXPECT_THROW(localizer.move({MoveKind::kAdvance, 1e6}), std::invalid_argument);
  EXPECT_THROW(localizer.move({MoveKind::kTurnLeft, -0.1}), std::invalid_argument);
  EXPECT_THROW(localizer.perceive(std::vector<float>(7, 1.0F)), std::invalid_argument);
  EXPECT_THROW(localizer.perceive(std::vector<float>(6, -1.0F)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(localizer.relocalization_moves({nan, 0.0, 0.0})),
               std::invalid_argument);
  EXPECT_NEAR(localizer.expected().x_m, 1.35, 1e-12);
  for (std::size_t i = 0; i < before.size(); ++i) {
    ASSERT_EQ(localizer.belief().current()[i], before[i]);
  }
  MarkovConfig config;
  config.window_cells = 20;
  EXPECT_THROW(MarkovLocalizer(config, room.cells(), ring), std::invalid_argument);
  config = {};
  config.perceptual_weight = 1.1;
  EXPECT_THROW(MarkovLocalizer(config, room.cells(), ring), std::invalid_argument);
  EXPECT_THROW(MarkovLocalizer({}, room.cells(), {}), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::markov
