#include "topogeo/scan/no_return.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::scan {
namespace {

using geometry::Pose2;

/// A corridor, 2 m wide, closed at x = 0 and x = 30 m, with a laser of 180 beams all around.
struct Corridor {
  double noise_m = 0.01;
  double quantum_m = 0.001;
  float limit_m = 8.0F;        // echoes from farther away are lost
  float no_return_m = 8.187F;  // reported instead
  std::mt19937 random{7};

  std::vector<float> scan(const Pose2& pose) {
    std::normal_distribution<double> noise(0.0, noise_m);
    std::vector<float> ranges_m;
    for (int i = 0; i < 180; ++i) {
      const double angle = pose.theta_rad + i * std::numbers::pi / 90.0;
      const double along = std::cos(angle);
      const double across = std::sin(angle);
      double range_m = 1e9;
      if (along != 0.0) range_m = std::min(range_m, ((along > 0 ? 30.0 : 0.0) - pose.x_m) / along);
      if (across != 0.0) {
        range_m = std::min(range_m, ((across > 0 ? 1.0 : -1.0) - pose.y_m) / across);
      }
      range_m = quantum_m * std::round((range_m + noise(random)) / quantum_m);
      ranges_m.push_back(range_m < limit_m ? static_cast<float>(range_m) : no_return_m);
    }
    return ranges_m;
  }

  /// A drive along it, a scan each `step_m`.
  std::optional<NoReturn> drive(double step_m = 0.1, double way_m = 28.0) {
    NoReturnFinder finder;
    for (double x_m = 1.0; x_m < 1.0 + way_m; x_m += step_m) {
      const Pose2 pose{x_m, 0.2 * std::sin(x_m), 0.1 * std::sin(3.0 * x_m)};
      finder.add(scan(pose), pose);
    }
    return finder.find();
  }
};

TEST(NoReturn, IsFoundWhereTheLaserReportsItForLostEchoes) {
  const auto found = Corridor{}.drive();
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->range_m, 8.187, 1e-9);
  EXPECT_NEAR(found->least_m, 8.1865, 1e-9);
  EXPECT_GT(found->share, 0.05);
  EXPECT_LT(found->share, 0.2);
}

TEST(NoReturn, IsNamedInOneLine) {
  EXPECT_EQ(text_of({8.187, 8.1865, 0.0654}),
            "a reading of 8.187 m means no echo (6.5 % of the readings)");
}

TEST(NoReturn, SeveralValuesOfOneLaserAreFoundTogether) {
  Corridor corridor;
  NoReturnFinder finder;
  for (int i = 0; i < 200; ++i) {
    const Pose2 pose{1.0 + 0.14 * i, 0.0, 0.0};
    std::vector<float> ranges_m = corridor.scan(pose);
    int lost = 0;
    for (float& range_m : ranges_m) {
      if (range_m == corridor.no_return_m && ++lost % 3 == 0) range_m = 8.183F;
    }
    finder.add(ranges_m, pose);
  }
  const auto found = finder.find();
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->range_m, 8.187, 1e-9);
  EXPECT_NEAR(found->least_m, 8.1825, 1e-9);
}

TEST(NoReturn, RangesThatEndAtALimitAreNone) {
  for (const double quantum_m : {0.001, 0.01, 0.05, 0.1}) {
    for (const float limit_m : {2.0F, 4.0F, 8.0F}) {
      Corridor corridor;
      corridor.quantum_m = quantum_m;
      corridor.limit_m = limit_m;
      corridor.no_return_m = 0.0F;
      EXPECT_FALSE(corridor.drive()) << quantum_m << ' ' << limit_m;
    }
  }
}

TEST(NoReturn, IsFoundWithACoarseLaserToo) {
  for (const double quantum_m : {0.01, 0.05, 0.1}) {
    for (const float limit_m : {4.0F, 8.0F, 15.0F}) {
      Corridor corridor;
      corridor.quantum_m = quantum_m;
      corridor.limit_m = limit_m;
      corridor.no_return_m = limit_m + 0.1F;
      EXPECT_TRUE(corridor.drive()) << quantum_m << ' ' << limit_m;
    }
  }
}

TEST(NoReturn, AWallBeforeAStandingRobotIsNone) {
  Corridor corridor;
  corridor.noise_m = 0.0;  // the end of the corridor gives one range for hours
  corridor.quantum_m = 0.05;
  corridor.limit_m = 50.0F;
  NoReturnFinder finder;
  for (double x_m = 16.0; x_m < 20.0; x_m += 0.1) {
    finder.add(corridor.scan({x_m, 0.0, 0.0}), {x_m, 0.0, 0.0});
  }
  for (int i = 0; i < 20'000; ++i) finder.add(corridor.scan({20.0, 0.0, 0.0}), {20.0, 0.0, 0.0});
  EXPECT_FALSE(finder.find());
}

TEST(NoReturn, AWallThatTheRobotTurnsBeforeIsNone) {
  Corridor corridor;
  corridor.noise_m = 0.0;
  corridor.quantum_m = 0.05;
  corridor.limit_m = 50.0F;
  NoReturnFinder finder;
  for (double x_m = 16.0; x_m < 20.0; x_m += 0.1) {
    finder.add(corridor.scan({x_m, 0.0, 0.0}), {x_m, 0.0, 0.0});
  }
  for (int i = 0; i < 1000; ++i) {
    const Pose2 pose{20.0, 0.0, 0.05 * i};
    finder.add(corridor.scan(pose), pose);
  }
  EXPECT_FALSE(finder.find());
}

TEST(NoReturn, ARoomWhoseFarWallHasOneDistanceIsNone) {
  // Drives along the far wall of a room, always 5 m away from it, 100 times.
  Corridor corridor;
  corridor.quantum_m = 0.01;
  corridor.limit_m = 50.0F;
  NoReturnFinder finder;
  for (int i = 0; i < 4000; ++i) {
    const double x_m = 10.0 + 5.0 * std::sin(0.05 * i);
    std::vector<float> ranges_m = corridor.scan({x_m, 0.0, 0.0});
    for (std::size_t beam = 40; beam <= 50; ++beam) {
      ranges_m[beam] =
          5.0F / static_cast<float>(std::sin(static_cast<double>(beam) * std::numbers::pi / 90.0));
    }
    finder.add(ranges_m, {x_m, 0.0, 0.0});
  }
  EXPECT_FALSE(finder.find());
}

TEST(NoReturn, NeedsSeveralPlaces) {
  EXPECT_FALSE(Corridor{}.drive(0.1, 1.0));
  EXPECT_FALSE(NoReturnFinder{}.find());
}

TEST(NoReturn, WithoutOdometryTheViewTellsThePlaces) {
  Corridor corridor;
  NoReturnFinder standing;
  for (int i = 0; i < 100; ++i) standing.add_without_odometry(corridor.scan({5.0, 0.0, 0.0}));
  EXPECT_EQ(standing.places(), 1U);
  NoReturnFinder driving;
  for (double x_m = 1.0; x_m < 29.0; x_m += 0.05) {
    driving.add_without_odometry(corridor.scan({x_m, 0.2 * std::sin(x_m), 0.3 * std::sin(x_m)}));
  }
  EXPECT_GE(driving.places(), NoReturnFinder::kLeastPlaces);
  const auto found = driving.find();
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->range_m, 8.187, 1e-9);
}

TEST(NoReturn, IsFoundOnTheWay) {
  Corridor corridor;
  NoReturnWatch watch;
  int found = 0;
  for (int i = 0; i < 100; ++i) {
    const Pose2 pose{1.0 + 0.21 * i, 0.0, 0.0};
    const bool now = watch.add(corridor.scan(pose), pose);
    EXPECT_EQ(now, i == 29) << i;
    found += now ? 1 : 0;
  }
  EXPECT_EQ(found, 1);
  ASSERT_TRUE(watch.found());
  EXPECT_NEAR(watch.found()->range_m, 8.187, 1e-9);
}

TEST(NoReturn, BadReadingsHaveNoValue) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  NoReturnFinder finder;
  for (int i = 0; i < 100; ++i) {
    const std::vector<float> ranges_m{kNan, kInfinity, -kInfinity, -1.0F, 0.0F, 3e38F, kNan};
    finder.add(ranges_m, {1.0 * i, 0.0, 0.0});
  }
  EXPECT_FALSE(finder.find());
}

}  // namespace
}  // namespace topogeo::scan
