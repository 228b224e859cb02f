#include "topogeo/geometry/pose2.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

namespace topogeo::geometry {
namespace {

constexpr double kHalfTurn_rad = std::numbers::pi;

class RandomPoses {
 public:
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 18446744073709551616.0);
  }
  // Box and Muller's method gives two draws; one is enough here.
  double normal() {
    return std::sqrt(-2.0 * std::log(uniform(1e-12, 1.0))) *
           std::cos(uniform(0.0, 2.0 * kHalfTurn_rad));
  }
  Pose2 pose() {
    return {uniform(-20, 20), uniform(-20, 20), uniform(-kHalfTurn_rad, kHalfTurn_rad)};
  }

 private:
  std::mt19937_64 random_{17};
};

void expect_near(const Pose2& a, const Pose2& b, double tolerance) {
  EXPECT_NEAR(a.x_m, b.x_m, tolerance);
  EXPECT_NEAR(a.y_m, b.y_m, tolerance);
  EXPECT_NEAR(wrap_angle(a.theta_rad - b.theta_rad), 0.0, tolerance);
}

TEST(WrapAngle, LeavesWhatIsInRangeAsItIs) {
  for (const double angle : {0.0, 1.0, -3.0, kHalfTurn_rad, std::nextafter(-kHalfTurn_rad, 0.0)}) {
    EXPECT_EQ(wrap_angle(angle), angle);
  }
}

TEST(WrapAngle, HasOneNameForTheHalfTurn) {
  EXPECT_EQ(wrap_angle(-kHalfTurn_rad), kHalfTurn_rad);
  EXPECT_NEAR(wrap_angle(3.0 * kHalfTurn_rad), kHalfTurn_rad, 1e-14);
  EXPECT_NEAR(std::fabs(wrap_angle(-3.0 * kHalfTurn_rad)), kHalfTurn_rad, 1e-14);
  EXPECT_NEAR(wrap_angle(kHalfTurn_rad + 0.1), -kHalfTurn_rad + 0.1, 1e-15);
  EXPECT_NEAR(wrap_angle(-kHalfTurn_rad - 0.1), kHalfTurn_rad - 0.1, 1e-15);
}

TEST(WrapAngle, StaysInRangeAndKeepsTheDirection) {
  RandomPoses random;
  for (int i = 0; i < 20000; ++i) {
    const double angle = random.uniform(-1e5, 1e5);
    const double wrapped = wrap_angle(angle);
    ASSERT_GT(wrapped, -kHalfTurn_rad) << angle;
    ASSERT_LE(wrapped, kHalfTurn_rad) << angle;
    ASSERT_NEAR(std::sin(wrapped), std::sin(angle), 1e-10);
    ASSERT_NEAR(std::cos(wrapped), std::cos(angle), 1e-10);
  }
  for (int k = -1000; k <= 1000; ++k) {
    for (const double angle : {kHalfTurn_rad * k, std::nextafter(kHalfTurn_rad * k, 1e9),
                               std::nextafter(kHalfTurn_rad * k, -1e9)}) {
      EXPECT_GT(wrap_angle(angle), -kHalfTurn_rad) << k;
      EXPECT_LE(wrap_angle(angle), kHalfTurn_rad) << k;
    }
  }
}

TEST(Pose2, ComposesAQuarterTurnByHand) {
  // One metre ahead of a robot at (2, 3) that faces +y.
  const Pose2 T_a_b{2, 3, kHalfTurn_rad / 2.0};
  expect_near(T_a_b * Pose2{1, 0, 0}, {2, 4, kHalfTurn_rad / 2.0}, 1e-15);
  EXPECT_NEAR((T_a_b * Eigen::Vector2d(0, 1)).x(), 1.0, 1e-15);
  EXPECT_NEAR((T_a_b * Eigen::Vector2d(0, 1)).y(), 3.0, 1e-15);
  expect_near(inverse(T_a_b), {-3, 2, -kHalfTurn_rad / 2.0}, 1e-15);
  expect_near(between(T_a_b, {2, 5, kHalfTurn_rad}), {2, 0, kHalfTurn_rad / 2.0}, 1e-15);
}

TEST(Pose2, IsAGroup) {
  RandomPoses random;
  for (int i = 0; i < 2000; ++i) {
    const Pose2 a = random.pose();
    const Pose2 b = random.pose();
    const Pose2 c = random.pose();
    expect_near((a * b) * c, a * (b * c), 1e-12);
    expect_near(a * inverse(a), {}, 1e-13);
    expect_near(inverse(a) * a, {}, 1e-13);
    expect_near(inverse(a * b), inverse(b) * inverse(a), 1e-12);
    expect_near(a * between(a, b), b, 1e-12);
    EXPECT_EQ(a * Pose2{}, a);
    EXPECT_EQ(Pose2{} * a, a);
    const Eigen::Vector2d p(random.uniform(-9, 9), random.uniform(-9, 9));
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-12);
    EXPECT_LT(((a * b).position_m() - a * b.position_m()).norm(), 1e-15);
  }
}

TEST(Pose2, KeepsTheAngleInRangeAcrossTheHalfTurn) {
  const Pose2 sum = Pose2{0, 0, 3.0} * Pose2{0, 0, 0.5};
  EXPECT_NEAR(sum.theta_rad, 3.5 - 2.0 * kHalfTurn_rad, 1e-15);
  EXPECT_EQ(inverse(Pose2{0, 0, kHalfTurn_rad}).theta_rad, kHalfTurn_rad);
  EXPECT_EQ((Pose2{0, 0, kHalfTurn_rad / 2.0} * Pose2{0, 0, kHalfTurn_rad / 2.0}).theta_rad,
            kHalfTurn_rad);
}

using Function = std::function<Pose2(const Eigen::Vector3d&)>;

// Central differences of a pose-valued function at 0.
Eigen::Matrix3d differences(const Function& f) {
  constexpr double kStep = 1e-6;
  Eigen::Matrix3d jacobian;
  for (int k = 0; k < 3; ++k) {
    const Pose2 high = f(kStep * Eigen::Vector3d::Unit(k));
    const Pose2 low = f(-kStep * Eigen::Vector3d::Unit(k));
    jacobian.col(k) << high.x_m - low.x_m, high.y_m - low.y_m,
        wrap_angle(high.theta_rad - low.theta_rad);
  }
  return jacobian / (2.0 * kStep);
}

Pose2 plus(const Pose2& p, const Eigen::Vector3d& d) {
  return {p.x_m + d.x(), p.y_m + d.y(), p.theta_rad + d.z()};
}

Eigen::Matrix3d random_covariance(RandomPoses& random) {
  Eigen::Matrix3d a;
  for (int i = 0; i < 9; ++i) a(i / 3, i % 3) = random.uniform(-1, 1);
  return a * a.transpose();
}

TEST(Covariance, OfACompositionAgreesWithNumericDifferentiation) {
  RandomPoses random;
  for (int i = 0; i < 200; ++i) {
    const Pose2 a = random.pose();
    const Pose2 b = random.pose();
    const Eigen::Matrix3d cov_a = random_covariance(random);
    const Eigen::Matrix3d cov_b = random_covariance(random);
    const Eigen::Matrix3d first = differences([&](const auto& d) { return plus(a, d) * b; });
    const Eigen::Matrix3d second = differences([&](const auto& d) { return a * plus(b, d); });
    const Eigen::Matrix3d expected =
        first * cov_a * first.transpose() + second * cov_b * second.transpose();
    const Eigen::Matrix3d actual = compose_covariance(a, cov_a, b, cov_b);
    EXPECT_LT((actual - expected).norm(), 1e-7 * expected.norm());
    EXPECT_LT((actual - actual.transpose()).norm(), 1e-12 * actual.norm());
  }
}

TEST(Covariance, OfAnInverseAgreesWithNumericDifferentiation) {
  RandomPoses random;
  for (int i = 0; i < 200; ++i) {
    const Pose2 a = random.pose();
    const Eigen::Matrix3d cov = random_covariance(random);
    const Eigen::Matrix3d j = differences([&](const auto& d) { return inverse(plus(a, d)); });
    const Eigen::Matrix3d expected = j * cov * j.transpose();
    EXPECT_LT((inverse_covariance(a, cov) - expected).norm(), 1e-7 * expected.norm());
    // Inverting it twice restores it.
    const Eigen::Matrix3d twice = inverse_covariance(inverse(a), inverse_covariance(a, cov));
    EXPECT_LT((twice - cov).norm(), 1e-9 * cov.norm());
  }
}

TEST(Covariance, OfACompositionAgreesWithSampling) {
  RandomPoses random;
  const Pose2 a{1, 2, 0.7};
  const Pose2 b{3, -1, -0.4};
  const Eigen::Vector3d sigma_a(0.02, 0.03, 0.01);
  const Eigen::Vector3d sigma_b(0.01, 0.04, 0.02);
  const Pose2 mean = a * b;
  Eigen::Matrix3d sampled = Eigen::Matrix3d::Zero();
  constexpr int kSamples = 40000;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d da(random.normal(), random.normal(), random.normal());
    const Eigen::Vector3d db(random.normal(), random.normal(), random.normal());
    const Pose2 c = plus(a, sigma_a.cwiseProduct(da)) * plus(b, sigma_b.cwiseProduct(db));
    const Eigen::Vector3d d(c.x_m - mean.x_m, c.y_m - mean.y_m,
                            wrap_angle(c.theta_rad - mean.theta_rad));
    sampled += d * d.transpose() / kSamples;
  }
  const Eigen::Matrix3d expected =
      compose_covariance(a, sigma_a.cwiseAbs2().asDiagonal(), b, sigma_b.cwiseAbs2().asDiagonal());
  EXPECT_LT((sampled - expected).norm(), 0.03 * expected.norm());
}

TEST(Mahalanobis, IsTheSquaredLengthAfterWhitening) {
  RandomPoses random;
  for (int i = 0; i < 200; ++i) {
    // Not nearly singular, because neither method is exact there.
    const Eigen::Matrix3d cov = random_covariance(random) + 0.01 * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d d(random.normal(), random.normal(), random.normal());
    const Eigen::Vector3d white = Eigen::LLT<Eigen::Matrix3d>(cov).matrixL().solve(d);
    EXPECT_NEAR(squared_mahalanobis(d, cov), white.squaredNorm(), 1e-9 * white.squaredNorm());
  }
}

TEST(Mahalanobis, NinetyNinePercentStayBelowTheirLimit) {
  RandomPoses random;
  constexpr int kSamples = 20000;
  int above = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d d(0.1 * random.normal(), 0.2 * random.normal(), 0.03 * random.normal());
    const Eigen::Matrix3d cov = Eigen::Vector3d(0.01, 0.04, 0.0009).asDiagonal();
    if (squared_mahalanobis(d, cov) > kMahalanobis2Of99Percent) ++above;
  }
  EXPECT_NEAR(above, 0.01 * kSamples, 50);
}

}  // namespace
}  // namespace topogeo::geometry
