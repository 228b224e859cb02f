#include "topogeo/geometry/portable_math.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace topogeo::geometry {
namespace {

constexpr double kPi = std::numbers::pi;

// Distance in units of the last place of the exact value, for values that are not tiny.
double ulps(double value, double exact) {
  const double unit = std::nextafter(std::fabs(exact), 1e308) - std::fabs(exact);
  return std::fabs(value - exact) / unit;
}

class Uniform {
 public:
  double operator()(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 18446744073709551616.0);
  }

 private:
  std::mt19937_64 random_{5};
};

TEST(PortableMath, SineAndCosineFollowLibm) {
  Uniform uniform;
  for (const double range : {0.8, 4.0, 100.0, 1e5}) {
    for (int i = 0; i < 50000; ++i) {
      const double angle = uniform(-range, range);
      const SinCos r = sincos(angle);
      // Relative to 1: near a zero a rotation depends on the absolute error.
      ASSERT_NEAR(r.sin, std::sin(angle), 4e-16) << angle;
      ASSERT_NEAR(r.cos, std::cos(angle), 4e-16) << angle;
    }
  }
}

TEST(PortableMath, SineOfSmallAnglesIsExactToTheLastPlaces) {
  Uniform uniform;
  for (int i = 0; i < 50000; ++i) {
    const double angle = uniform(1e-9, 0.7);
    ASSERT_LE(ulps(sincos(angle).sin, std::sin(angle)), 2.0) << angle;
  }
  EXPECT_EQ(sincos(0.0).sin, 0.0);
  EXPECT_EQ(sincos(0.0).cos, 1.0);
  EXPECT_EQ(sincos(-0.3).sin, -sincos(0.3).sin);
  EXPECT_EQ(sincos(-0.3).cos, sincos(0.3).cos);
}

TEST(PortableMath, SineAndCosineOfQuarterTurns) {
  const double quarters[5][2] = {{0, 1}, {1, 0}, {0, -1}, {-1, 0}, {0, 1}};
  for (int k = 0; k <= 4; ++k) {
    for (const int sign : {1, -1}) {
      const SinCos r = sincos(sign * k * kPi / 2.0);
      EXPECT_NEAR(r.sin, sign * quarters[k][0], 5e-16) << k;
      EXPECT_NEAR(r.cos, quarters[k][1], 5e-16) << k;
    }
  }
}

// Strangers may send poses with such headings.
TEST(PortableMath, SineAndCosineOfAnyNumberAreOnTheCircleOrNone) {
  for (const double angle : {1e9, -3e12, 2.3e180, -std::numeric_limits<double>::max()}) {
    const SinCos at = sincos(angle);
    EXPECT_NEAR(at.sin * at.sin + at.cos * at.cos, 1.0, 1e-12) << angle;
  }
  const SinCos none = sincos(std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(none.sin) && std::isnan(none.cos));
  EXPECT_TRUE(std::isnan(sincos(std::nan("")).sin));
}

TEST(PortableMath, ArcTangentFollowsLibm) {
  Uniform uniform;
  for (int i = 0; i < 200000; ++i) {
    const double scale = std::pow(10.0, uniform(-6, 6));
    const double y = uniform(-1, 1);
    const double x = uniform(-1, 1) * scale;
    ASSERT_LE(ulps(atan2(y, x), std::atan2(y, x)), 4.0) << y << ' ' << x;
  }
}

TEST(PortableMath, ArcTangentOnTheAxes) {
  EXPECT_EQ(atan2(0.0, 0.0), 0.0);
  EXPECT_EQ(atan2(0.0, 2.0), 0.0);
  EXPECT_EQ(atan2(0.0, -2.0), kPi);
  EXPECT_EQ(atan2(-0.0, -2.0), kPi);  // (-pi, pi]: the half turn has only one value
  EXPECT_EQ(atan2(3.0, 0.0), kPi / 2.0);
  EXPECT_EQ(atan2(-3.0, 0.0), -kPi / 2.0);
  EXPECT_NEAR(atan2(1.0, 1.0), kPi / 4.0, 2e-16);
  EXPECT_NEAR(atan2(-1e-300, -1.0), -kPi, 1e-15);
}

TEST(PortableMath, ArcTangentUndoesSineAndCosine) {
  for (int i = -314; i <= 314; ++i) {
    const double angle = i / 100.0;
    const SinCos r = sincos(angle);
    EXPECT_NEAR(atan2(r.sin, r.cos), angle, 1e-15);
  }
}

TEST(PortableMath, ExponentialFollowsLibm) {
  Uniform uniform;
  for (const double range : {0.5, 20.0, 700.0}) {
    for (int i = 0; i < 50000; ++i) {
      const double x = uniform(-range, range);
      ASSERT_LE(ulps(exp(x), std::exp(x)), 3.0) << x;
    }
  }
  EXPECT_EQ(exp(0.0), 1.0);
  EXPECT_EQ(exp(-701.0), 0.0);
  EXPECT_EQ(exp(-std::numeric_limits<double>::infinity()), 0.0);
  EXPECT_EQ(exp(1000.0), exp(700.0));
}

TEST(PortableMath, LogarithmFollowsLibm) {
  Uniform uniform;
  for (int i = 0; i < 100000; ++i) {
    const double x = std::pow(10.0, uniform(-300, 300));
    ASSERT_LE(ulps(log(x), std::log(x)), 3.0) << x;
  }
  // Near 1 the result is near 0, where only careful arithmetic keeps the last places.
  for (int i = 0; i < 100000; ++i) {
    const double x = uniform(0.5, 2.0);
    ASSERT_NEAR(log(x), std::log(x), 3e-16) << x;
  }
  EXPECT_EQ(log(1.0), 0.0);
  EXPECT_NEAR(log(std::numeric_limits<double>::min()), -708.3964185322641, 1e-12);
}

TEST(PortableMath, LogarithmUndoesTheExponential) {
  for (int i = -700; i <= 700; ++i) EXPECT_NEAR(log(exp(i)), i, 1e-15 * std::abs(i) + 1e-15);
}

}  // namespace
}  // namespace topogeo::geometry
