#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::localization {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Matrix2d covariance(double xx, double xy, double yy) {
  Eigen::Matrix2d c;
  c << xx, xy, xy, yy;
  return c;
}

/// R diag(a^2, b^2) R^T: the covariance with these axes.
Eigen::Matrix2d turned(double a_m, double b_m, double direction_rad) {
  Eigen::Matrix2d r;
  r << std::cos(direction_rad), -std::sin(direction_rad), std::sin(direction_rad),
      std::cos(direction_rad);
  return r * Eigen::Vector2d(a_m * a_m, b_m * b_m).asDiagonal() * r.transpose();
}

Eigen::Matrix2d random_covariance(support::Random& random) {
  return turned(random.uniform(0.1, 3.0), random.uniform(0.01, 0.1), random.uniform(-kPi, kPi));
}

TEST(ErrorEllipseTest, K2IsTheTableOfTheSource) {
  EXPECT_NEAR(ellipse_k2(0.50), 1.386, 0.0005);
  EXPECT_NEAR(ellipse_k2(0.90), 4.605, 0.0005);
  EXPECT_NEAR(ellipse_k2(0.95), 5.991, 0.0005);
}

TEST(ErrorEllipseTest, RefusesWhatIsNoProbability) {
  for (const double wrong : {0.0, 1.0, -0.1, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(ellipse_k2(wrong), std::invalid_argument) << wrong;
  }
}

TEST(ErrorEllipseTest, AxesAlongXAndYByHand) {
  const ErrorEllipse along_x = error_ellipse(covariance(9.0, 0.0, 4.0), 1.0);
  EXPECT_DOUBLE_EQ(along_x.semi_major_m, 3.0);
  EXPECT_DOUBLE_EQ(along_x.semi_minor_m, 2.0);
  EXPECT_DOUBLE_EQ(along_x.direction_rad, 0.0);
  // Eq. 6.18 as printed gives 0 here too, the minor axis.
  const ErrorEllipse along_y = error_ellipse(covariance(4.0, 0.0, 9.0), 4.0);
  EXPECT_DOUBLE_EQ(along_y.semi_major_m, 6.0);
  EXPECT_DOUBLE_EQ(along_y.semi_minor_m, 4.0);
  EXPECT_NEAR(along_y.direction_rad, kPi / 2.0, 1e-15);
}

TEST(ErrorEllipseTest, DirectionIsThatOfTheMajorAxisAllRound) {
  for (int degrees = -89; degrees <= 90; ++degrees) {
    const double direction_rad = degrees * kPi / 180.0;
    const ErrorEllipse ellipse = error_ellipse(turned(2.0, 0.5, direction_rad), 1.0);
    // An axis has no sign: compare modulo half a turn.
    EXPECT_NEAR(std::sin(ellipse.direction_rad - direction_rad), 0.0, 1e-12) << degrees;
    EXPECT_GT(ellipse.direction_rad, -kPi / 2.0);
    EXPECT_LE(ellipse.direction_rad, kPi / 2.0);
  }
}

TEST(ErrorEllipseTest, AgreesWithTheEigenDecomposition) {
  support::Random random(3);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Matrix2d c = random_covariance(random);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(c);  // ascending
    const ErrorEllipse ellipse = error_ellipse(c, 5.991);
    EXPECT_NEAR(ellipse.semi_minor_m, std::sqrt(5.991 * eigen.eigenvalues()(0)), 1e-9);
    EXPECT_NEAR(ellipse.semi_major_m, std::sqrt(5.991 * eigen.eigenvalues()(1)), 1e-9);
    const Eigen::Vector2d axis(std::cos(ellipse.direction_rad), std::sin(ellipse.direction_rad));
    EXPECT_NEAR(std::fabs(axis.dot(eigen.eigenvectors().col(1))), 1.0, 1e-9);
  }
}

TEST(ErrorEllipseTest, AgreesWithTheFormOfTheSource) {
  support::Random random(4);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Matrix2d c = random_covariance(random);
    const Eigen::Matrix2d inverse = c.inverse();
    const double a = inverse(0, 0);
    const double b = 0.5 * (inverse(0, 1) + inverse(1, 0));  // 6.17
    const double cc = inverse(1, 1);
    const double t = std::sqrt(a * a + cc * cc - 2.0 * a * cc + 4.0 * b * b);  // 6.20
    const ErrorEllipse ellipse = error_ellipse(c, 4.605);
    EXPECT_NEAR(ellipse.semi_minor_m, std::sqrt(2.0 * 4.605 / (a + cc + t)), 1e-9);  // 6.19
    EXPECT_NEAR(ellipse.semi_major_m / std::sqrt(2.0 * 4.605 / (a + cc - t)), 1.0, 1e-6);
    EXPECT_NEAR(std::sin(ellipse.direction_rad - 0.5 * std::atan2(-2.0 * b, cc - a)), 0.0, 1e-9);
  }
}

TEST(ErrorEllipseTest, RectangleIsKTimesTheDeviationsAndTouchesTheEllipse) {
  support::Random random(5);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Matrix2d c = random_covariance(random);
    const double k = std::sqrt(ellipse_k2(0.95));
    const ErrorEllipse ellipse = error_ellipse(c, k * k);
    const Eigen::Vector2d half_m = bounding_half_width_m(ellipse);
    EXPECT_NEAR(half_m.x(), k * std::sqrt(c(0, 0)), 1e-9);
    EXPECT_NEAR(half_m.y(), k * std::sqrt(c(1, 1)), 1e-9);

    // Points of the ellipse: on the quadric of 6.14, and their extremes are the rectangle.
    Eigen::Vector2d largest_m = Eigen::Vector2d::Zero();
    for (int j = 0; j < 3600; ++j) {
      const double angle = j * kPi / 1800.0;
      const double u = ellipse.semi_major_m * std::cos(angle);
      const double v = ellipse.semi_minor_m * std::sin(angle);
      const double cosine = std::cos(ellipse.direction_rad);
      const double sine = std::sin(ellipse.direction_rad);
      const Eigen::Vector2d p(cosine * u - sine * v, sine * u + cosine * v);
      EXPECT_NEAR(p.dot(c.inverse() * p) / (k * k), 1.0, 1e-6);
      largest_m = largest_m.cwiseMax(p);
    }
    EXPECT_NEAR(half_m.x() / largest_m.x(), 1.0, 1e-5);
    EXPECT_NEAR(half_m.y() / largest_m.y(), 1.0, 1e-5);
  }
}

TEST(ErrorEllipseTest, HoldsTheShareOfRandomPositionsThatItSays) {
  const Eigen::Matrix2d c = turned(0.4, 0.1, 0.7);
  const Eigen::Matrix2d root = c.llt().matrixL();
  for (const double probability : {0.5, 0.9, 0.95}) {
    const ErrorEllipse ellipse = error_ellipse(c, ellipse_k2(probability));
    const double cosine = std::cos(ellipse.direction_rad);
    const double sine = std::sin(ellipse.direction_rad);
    support::Random random(6);
    constexpr int kPositions = 20000;
    int inside = 0;
    for (int i = 0; i < kPositions; ++i) {
      const Eigen::Vector2d p = root * Eigen::Vector2d(random.normal(), random.normal());
      const double u = (cosine * p.x() + sine * p.y()) / ellipse.semi_major_m;
      const double v = (-sine * p.x() + cosine * p.y()) / ellipse.semi_minor_m;
      if (u * u + v * v <= 1.0) ++inside;
    }
    EXPECT_NEAR(static_cast<double>(inside) / kPositions, probability, 0.012);
  }
}

TEST(ErrorEllipseTest, DegenerateCovariancesAreFlatOrEmpty) {
  const ErrorEllipse line = error_ellipse(covariance(1.0, 1.0, 1.0), 2.0);
  EXPECT_NEAR(line.semi_major_m, 2.0, 1e-12);
  EXPECT_EQ(line.semi_minor_m, 0.0);
  EXPECT_NEAR(line.direction_rad, kPi / 4.0, 1e-12);
  const ErrorEllipse point = error_ellipse(Eigen::Matrix2d::Zero(), 5.991);
  EXPECT_EQ(point.semi_major_m, 0.0);
  EXPECT_EQ(point.semi_minor_m, 0.0);
  EXPECT_TRUE(bounding_half_width_m(point).isZero(0.0));
}

TEST(ErrorEllipseTest, RefusesWhatIsNoCovariance) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(error_ellipse(covariance(1.0, 1.1, 1.0), 1.0), std::invalid_argument);
  EXPECT_THROW(error_ellipse(covariance(-1.0, 0.0, 1.0), 1.0), std::invalid_argument);
  EXPECT_THROW(error_ellipse(covariance(nan, 0.0, 1.0), 1.0), std::invalid_argument);
  Eigen::Matrix2d skew = covariance(1.0, 0.2, 1.0);
  skew(1, 0) = 0.1;
  EXPECT_THROW(error_ellipse(skew, 1.0), std::invalid_argument);
  EXPECT_THROW(error_ellipse(covariance(1.0, 0.0, 1.0), -1.0), std::invalid_argument);
  EXPECT_THROW(error_ellipse(covariance(1.0, 0.0, 1.0), nan), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::localization
