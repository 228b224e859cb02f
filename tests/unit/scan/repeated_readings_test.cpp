#include "topogeo/scan/repeated_readings.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/scan/scan.hpp"

namespace topogeo::scan {
namespace {

std::vector<float> readings(float last_m) {
  std::vector<float> ranges_m(25, 2.0F);
  ranges_m[7] = Scan::kNoReturn;
  ranges_m.back() = last_m;
  return ranges_m;
}

const std::vector<float> kReadings_m = readings(3.0F);
const std::vector<float> kOthers_m = readings(3.001F);

TEST(RepeatedReadings, AreThoseOfAMovingRobotOnly) {
  RepeatedReadings repeated;
  EXPECT_FALSE(repeated.add(kReadings_m, {}, 0));
  EXPECT_FALSE(repeated.add(kReadings_m, {0.009, 0.0, 0.0}, 0)) << "it stands";
  EXPECT_TRUE(repeated.add(kReadings_m, {0.011, 0.0, 0.0}, 0)) << "since they came first";
  EXPECT_TRUE(repeated.add(kReadings_m, {0.0, 0.0, 0.006}, 0));
}

TEST(RepeatedReadings, EndWithANewReading) {
  RepeatedReadings repeated;
  EXPECT_FALSE(repeated.add(kReadings_m, {}, 0));
  EXPECT_FALSE(repeated.add(kOthers_m, {0.5, 0.0, 0.0}, 0));
  EXPECT_FALSE(repeated.add(kReadings_m, {1.0, 0.0, 0.0}, 0));
  EXPECT_TRUE(repeated.add(kReadings_m, {1.5, 0.0, 0.0}, 0));
}

TEST(RepeatedReadings, AreNoneWithFewEchoes) {
  std::vector<float> few(360, Scan::kNoReturn);
  std::fill_n(few.begin(), RepeatedReadings::kFewestEchoes - 1, 2.0F);
  RepeatedReadings repeated;
  EXPECT_FALSE(repeated.add(few, {}, 0));
  EXPECT_FALSE(repeated.add(few, {5.0, 0.0, 0.0}, 0));
  few.back() = 2.0F;
  EXPECT_FALSE(repeated.add(few, {10.0, 0.0, 0.0}, 0));
  EXPECT_TRUE(repeated.add(few, {15.0, 0.0, 0.0}, 0));
}

TEST(RepeatedReadings, AreNoneWhereTheOdometryRestarts) {
  RepeatedReadings repeated;
  EXPECT_FALSE(repeated.add(kReadings_m, {5.0, 0.0, 0.0}, 0));
  EXPECT_FALSE(repeated.add(kReadings_m, {}, 1));
  EXPECT_TRUE(repeated.add(kReadings_m, {0.1, 0.0, 0.0}, 1));
}

}  // namespace
}  // namespace topogeo::scan
