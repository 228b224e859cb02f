#include "topogeo/markov/sonar_model.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include <gmock/gmock.h>

#include "drawn_map.hpp"

namespace topogeo::markov {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kCells = std::size_t{21} * 21;  // of the window

/// Six sonars at the edge of a body of 3 x 3 cells, numbered like MACONDO's: front left, front
/// right, left front, left rear, right front, right rear.
std::vector<RangeSensor> six_at_the_edge() {
  return {{.T_robot_sensor = {0.15, 0.1, 0.0}},
          {.T_robot_sensor = {0.15, -0.1, 0.0}},
          {.T_robot_sensor = {0.1, 0.15, test::kQuarter_rad}},
          {.T_robot_sensor = {-0.1, 0.15, test::kQuarter_rad}},
          {.T_robot_sensor = {0.1, -0.15, -test::kQuarter_rad}},
          {.T_robot_sensor = {-0.1, -0.15, -test::kQuarter_rad}}};
}

TEST(SonarModel, VirtualReadingsCountTheCellsAsInFigure8) {
  // The robot covers the 3 x 3 cells drawn as _ and faces right. Between its edge and the nearest
  // obstacle there are (3, 3, 4, 3, 2, 2) cells.
  const ObstacleCells map = test::drawn({"....#.....",    // of sonar 2
                                         "..#.......",    // of sonar 3
                                         "..........",    //
                                         "..........",    //
                                         "..........",    //
                                         "..___...#.",    // of sonar 0
                                         "..___.....",    //
                                         "..___...#.",    // of sonar 1
                                         "..........",    //
                                         "..........",    //
                                         "..#.#....."});  // of sonars 5 and 4
  SonarModel sonar{six_at_the_edge(), {}};
  sonar.look_around(map, {0.35, 0.45, 0.0}, 5);
  const double cells[] = {3, 3, 4, 3, 2, 2};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(sonar.virtual_m(i, {0, 0}), 0.1 * cells[i], 1e-9) << "sonar " << i;
  }
}

/// Brute force: range at which a ray enters the nearest of all obstacles.
double ray_m(const ObstacleCells& map, const Eigen::Vector2d& from_m, double bearing_rad) {
  double nearest_m = kInfinity;
  const double along[] = {std::cos(bearing_rad), std::sin(bearing_rad)};
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      if (!map.occupied({x, y})) continue;
      const double low[] = {x * map.cell_m() - from_m.x(), y * map.cell_m() - from_m.y()};
      double enter = 0.0;
      double leave = kInfinity;
      for (int axis = 0; axis < 2; ++axis) {
        const double a = low[axis] / along[axis];
        const double b = (low[axis] + map.cell_m()) / along[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
      }
      if (enter < leave) nearest_m = std::min(nearest_m, enter);
    }
  }
  return nearest_m;
}

void expect_as_ray_by_ray(const ObstacleCells& map, const geometry::Pose2& pose, int size) {
  std::vector<RangeSensor> sensors = test::macondo_ring();
  sensors.push_back({.T_robot_sensor = {-0.05, 0.02, 2.5}});  // a laser beam
  SonarModelConfig config;
  config.max_range_m = 3.0;
  config.bands = {{2.5, 1.0}};
  SonarModel sonar{sensors, config};
  sonar.look_around(map, pose, size);
  const Cell centre = map.cell_of(pose.position_m());
  for (int y = -size / 2; y <= size / 2; ++y) {
    for (int x = -size / 2; x <= size / 2; ++x) {
      if (!map.free({centre.x + x, centre.y + y})) continue;
      const geometry::Pose2 there{pose.x_m + 0.1 * x, pose.y_m + 0.1 * y, pose.theta_rad};
      for (std::size_t i = 0; i < sensors.size(); ++i) {
        const geometry::Pose2 T_map_sensor = there * sensors[i].T_robot_sensor;
        double expected_m = kInfinity;
        for (const double part : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
          expected_m =
              std::min(expected_m, ray_m(map, T_map_sensor.position_m(),
                                         T_map_sensor.theta_rad + part * sensors[i].half_cone_rad));
        }
        if (expected_m > config.max_range_m) expected_m = kInfinity;
        const double virtual_m = sonar.virtual_m(i, {x, y});
        if (expected_m == kInfinity) {
          ASSERT_EQ(virtual_m, kInfinity) << x << ", " << y << ", sensor " << i;
        } else {
          ASSERT_NEAR(virtual_m, expected_m, 1e-9) << x << ", " << y << ", sensor " << i;
        }
      }
    }
  }
}

TEST(SonarModel, TheWholeWindowAtOnceEqualsRayByRay) {
  std::mt19937 random{5};
  std::uniform_real_distribution<double> uniform{0.0, 1.0};
  for (int run = 0; run < 4; ++run) {
    std::vector<std::uint8_t> cells(std::size_t{80} * 60);
    for (std::uint8_t& cell : cells) cell = uniform(random) < 0.015 ? 1 : 0;
    const ObstacleCells map{{.width = 80, .height = 60, .resolution_m = 0.1, .occupied = cells}};
    expect_as_ray_by_ray(
        map, {8.0 * uniform(random), 6.0 * uniform(random), 6.0 * uniform(random) - 3.0}, 9);
  }
}

TEST(SonarModel, WideWindowsTakeTwoWords) {
  std::vector<std::uint8_t> cells(std::size_t{110} * 8, 0);
  for (const std::size_t cell : {3U, 70U, 105U, 250U, 333U, 500U, 642U, 811U}) cells[cell] = 1;
  const ObstacleCells map{{.width = 110, .height = 8, .resolution_m = 0.1, .occupied = cells}};
  expect_as_ray_by_ray(map, {5.513, 0.437, 0.3}, 101);
}

TEST(SonarModel, NothingInRangeAndOutsideTheMapIsInfinity) {
  SonarModel sonar{six_at_the_edge(), {}};
  sonar.look_around(test::open_space(30, 30), {1.55, 1.55, 0.2}, 21);
  for (std::size_t i = 0; i < sonar.sensors(); ++i) {
    EXPECT_EQ(sonar.virtual_m(i, {0, 0}), kInfinity);
  }
  std::vector<double> probabilities(kCells);
  const PerceptualMatch match = sonar.compare(std::vector<float>(6, 1.0F), probabilities);
  EXPECT_EQ(match.reliability, 0.0);
  sonar.look_around(test::open_space(30, 30), {-1e6, 1e6, 0.0}, 21);
  EXPECT_FALSE(sonar.compare(std::vector<float>(6, 1.0F), probabilities).informative);
  for (const double probability : probabilities) EXPECT_EQ(probability, 0.0);
}

TEST(SonarModel, ReliabilityByExpectedDistance) {
  const SonarModelConfig config;
  EXPECT_EQ(reliability_of(config, 0.0), 1.0);
  EXPECT_EQ(reliability_of(config, 2.5), 1.0);
  EXPECT_EQ(reliability_of(config, 2.501), 0.25);
  EXPECT_EQ(reliability_of(config, 5.0), 0.25);
  EXPECT_EQ(reliability_of(config, 5.001), 0.0);
  EXPECT_EQ(reliability_of(config, kInfinity), 0.0);
}

TEST(SonarModel, ReliabilityOfTheVectorIsTheMean) {
  // A corridor 2 m wide and 7 m long, the robot 3.95 m before its end, lengthwise in the middle:
  // the front sonars expect some 3.8 m (25 %), those to the sides less than 1 m (100 %).
  const test::Room room{70, 20};
  SonarModel sonar{six_at_the_edge(), {}};
  sonar.look_around(room.cells(), {3.15, 1.15, 0.0}, 21);
  std::vector<double> probabilities(kCells);
  std::vector<float> ranges_m = room.measured({3.15, 1.15, 0.0}, six_at_the_edge());
  EXPECT_NEAR(sonar.compare(ranges_m, probabilities).reliability, (2 * 0.25 + 4) / 6.0, 1e-12);
  ranges_m[2] = scan::Scan::kNoReturn;  // counts as a reading without an echo
  const PerceptualMatch match = sonar.compare(ranges_m, probabilities);
  EXPECT_NEAR(match.reliability, (2 * 0.25 + 3) / 6.0, 1e-12);
  EXPECT_EQ(match.compared, 5);
}

TEST(SonarModel, TheSmallerTheDifferenceTheMoreProbable) {
  const test::Room room{30, 20};
  const std::vector<RangeSensor> sensors = six_at_the_edge();
  for (const PerceptualFormula formula :
       {PerceptualFormula::kExponential, PerceptualFormula::kInverse, PerceptualFormula::kLinear}) {
    SonarModelConfig config;
    config.formula = formula;
    SonarModel sonar{sensors, config};
    const geometry::Pose2 expected{2.05, 1.15, 0.0};
    sonar.look_around(room.cells(), expected, 21);
    // The robot is three cells ahead and two to the left of its estimate.
    const std::vector<float> ranges_m = room.measured({2.35, 1.35, 0.0}, sensors);
    std::vector<double> probabilities(kCells);
    const PerceptualMatch match = sonar.compare(ranges_m, probabilities);
    EXPECT_TRUE(match.informative);
    EXPECT_NEAR(match.best_difference_m, 0.0, 1e-6);
    const auto at = [&](int x, int y) {
      return probabilities[static_cast<std::size_t>(y + std::ptrdiff_t{10}) * 21 +
                           static_cast<std::size_t>(x + std::ptrdiff_t{10})];
    };
    double sum = 0.0;
    for (const double probability : probabilities) {
      sum += probability;
      EXPECT_LE(probability, at(3, 2));
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
    EXPECT_GT(at(3, 2), at(4, 2));
    EXPECT_GT(at(4, 2), at(5, 2));
    EXPECT_GT(at(3, 2), at(3, 1));
    EXPECT_EQ(at(3, 10), 0.0);  // in the wall
  }
}

TEST(SonarModel, TheFormulasAsDocumented) {
  // One sonar that faces a wall: the difference grows by 0.1 m for each cell towards it.
  const test::Room room{30, 20};
  const std::vector<RangeSensor> front{{.T_robot_sensor = {}}};
  const geometry::Pose2 expected{2.05, 1.15, 0.0};
  const std::vector<float> ranges_m = room.measured(expected, front);
  const auto ratio = [&](PerceptualFormula formula, int cells) {
    SonarModelConfig config;
    config.formula = formula;
    config.scale_m = 0.25;
    SonarModel sonar{front, config};
    sonar.look_around(room.cells(), expected, 21);
    std::vector<double> probabilities(kCells);
    sonar.compare(ranges_m, probabilities);
    const std::size_t middle = kCells / 2;
    return probabilities[middle + static_cast<std::size_t>(cells)] / probabilities[middle];
  };
  EXPECT_NEAR(ratio(PerceptualFormula::kExponential, 2), std::exp(-0.8), 1e-6);
  EXPECT_NEAR(ratio(PerceptualFormula::kInverse, 2), 1.0 / 1.8, 1e-6);
  EXPECT_NEAR(ratio(PerceptualFormula::kLinear, 2), 0.2, 1e-6);
  EXPECT_EQ(ratio(PerceptualFormula::kLinear, 3), 0.0);
  // 0.6 and 0.9 m of difference both count as the cap of 0.5 m.
  EXPECT_NEAR(ratio(PerceptualFormula::kExponential, 6), std::exp(-2.0), 1e-6);
  EXPECT_NEAR(ratio(PerceptualFormula::kExponential, 9), std::exp(-2.0), 1e-6);
}

TEST(SonarModel, UnreliableReadingsMayBeLeftOutOfTheDifference) {
  // 11 m long: the front sonar expects no echo, so its reading is wrong.
  const test::Room room{110, 20};
  const std::vector<RangeSensor> sensors = six_at_the_edge();
  std::vector<float> ranges_m = room.measured({2.05, 1.15, 0.0}, sensors);
  ranges_m[0] = 0.4F;
  std::vector<double> probabilities(kCells);
  SonarModelConfig config;
  SonarModel as_the_source{sensors, config};
  as_the_source.look_around(room.cells(), {2.05, 1.15, 0.0}, 21);
  EXPECT_NEAR(as_the_source.compare(ranges_m, probabilities).best_difference_m, 0.5 / 6, 1e-6);
  config.weigh_by_reliability = true;
  SonarModel weighing{sensors, config};
  weighing.look_around(room.cells(), {2.05, 1.15, 0.0}, 21);
  EXPECT_NEAR(weighing.compare(ranges_m, probabilities).best_difference_m, 0.0, 1e-6);
}

TEST(SonarModel, SonarsThatReadNothingSayNothing) {
  const test::Room room{30, 20};
  SonarModel sonar{six_at_the_edge(), {}};
  sonar.look_around(room.cells(), {1.05, 1.15, 0.0}, 21);
  std::vector<double> probabilities(kCells, 1.0);
  const PerceptualMatch match =
      sonar.compare(std::vector<float>(6, scan::Scan::kNoReturn), probabilities);
  EXPECT_FALSE(match.informative);
  EXPECT_EQ(match.compared, 0);
  EXPECT_EQ(match.reliability, 0.0);
  EXPECT_EQ(match.best_difference_m, kInfinity);
  for (const double probability : probabilities) EXPECT_EQ(probability, 0.0);
}

TEST(SonarModel, BadReadingsAreRefused) {
  SonarModel sonar{six_at_the_edge(), {}};
  sonar.look_around(test::open_space(30, 30), {1.0, 1.0, 0.0}, 21);
  std::vector<double> probabilities(kCells);
  EXPECT_THROW(sonar.compare(std::vector<float>(5, 1.0F), probabilities), std::invalid_argument);
  for (const float bad :
       {-0.1F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    std::vector<float> ranges_m(6, 1.0F);
    ranges_m[3] = bad;
    EXPECT_THROW(sonar.compare(ranges_m, probabilities), std::invalid_argument) << bad;
  }
}

TEST(SonarModel, AValueOutsideItsRangeIsNamed) {
  SonarModelConfig config;
  config.scale_m = 20.0;
  EXPECT_THAT([&] { check(config); },
              testing::ThrowsMessage<std::invalid_argument>(testing::StrEq(
                  "key 'markov.scale_m' = '20': expected number between 0.001 and 10 m")));
}

TEST(SonarModel, ConfigurationsOutOfRangeAreRefused) {
  EXPECT_NO_THROW(check(SonarModelConfig{}));
  const auto refused = [](auto change) {
    SonarModelConfig config;
    change(config);
    EXPECT_THROW(check(config), std::invalid_argument);
  };
  refused([](SonarModelConfig& c) { c.max_range_m = 4.0; });  // below the last band
  refused([](SonarModelConfig& c) { c.max_range_m = kInfinity; });
  refused([](SonarModelConfig& c) { c.rays_per_cone = 4; });
  refused([](SonarModelConfig& c) { c.rays_per_cone = 33; });
  refused([](SonarModelConfig& c) { c.bands.clear(); });
  refused([](SonarModelConfig& c) { c.bands = {{2.0, 0.5}, {1.0, 0.5}}; });
  refused([](SonarModelConfig& c) { c.bands = {{2.0, 1.5}}; });
  refused([](SonarModelConfig& c) { c.scale_m = 0.0; });
  refused([](SonarModelConfig& c) { c.difference_cap_m = 0.0; });
  EXPECT_THROW(SonarModel({}, {}), std::invalid_argument);
  EXPECT_THROW(SonarModel({{.T_robot_sensor = {9.0, 0.0, 0.0}}}, {}), std::invalid_argument);
  EXPECT_THROW(SonarModel({{.half_cone_rad = 2.0}}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::markov
