#include "topogeo/simulation/noisier_odometry.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace topogeo::simulation {
namespace {

using geometry::Pose2;
using Known = std::vector<std::optional<Pose2>>;

void expect_near(const Pose2& a, const Pose2& b) {
  const Eigen::Vector3d off = geometry::difference(a, b);
  EXPECT_NEAR(off.norm(), 0.0, 1e-12) << a.x_m << " " << a.y_m << " " << a.theta_rad;
}

// Steps of one metre that odometry measures as 1.1 m and 0.02 rad; the odometry frame is elsewhere.
const std::vector<Pose2> kTruth{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
std::vector<Pose2> recorded() {
  std::vector<Pose2> odometry{{5.0, 6.0, 1.0}};
  for (int i = 0; i < 3; ++i) odometry.push_back(odometry.back() * Pose2{1.1, 0.0, 0.02});
  return odometry;
}

TEST(NoisierOdometry, OneGivesTheRecordedOneAndZeroTheTruth) {
  const std::vector<Pose2> odometry = recorded();
  const Known known(kTruth.begin(), kTruth.end());
  const auto same = noisier_odometry(odometry, known, 1.0);
  const auto truth = noisier_odometry(odometry, known, 0.0);
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    expect_near(same[i], odometry[i]);
    expect_near(geometry::between(truth[0], truth[i]), kTruth[i]);
  }
}

TEST(NoisierOdometry, EveryStepErrsTheFactorMore) {
  const Known known(kTruth.begin(), kTruth.end());
  const auto doubled = noisier_odometry(recorded(), known, 2.0);
  for (std::size_t i = 1; i < doubled.size(); ++i) {
    expect_near(geometry::between(doubled[i - 1], doubled[i]), {1.2, 0.0, 0.04});
  }
}

TEST(NoisierOdometry, BetweenKnownPosesTheErrorGrowsWithTheWay) {
  // Three steps of 1, 0 and 3 m by odometry; in truth 4.4 m. The first quarter of the path gets a
  // quarter of the 0.4 m, standing still gets nothing.
  const std::vector<Pose2> odometry{{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {4, 0, 0}};
  const Known known{Pose2{}, std::nullopt, std::nullopt, Pose2{4.4, 0, 0}};
  const auto truth = noisier_odometry(odometry, known, 0.0);
  expect_near(truth[1], {1.1, 0, 0});
  expect_near(truth[2], {1.1, 0, 0});
  expect_near(truth[3], {4.4, 0, 0});
}

TEST(NoisierOdometry, StepsOutsideOfTheReferenceStayAsTheyAre) {
  const std::vector<Pose2> odometry{{0, 0, 0}, {1, 0, 0.1}, {2, 0, 0.1}, {3, 0, 0.5}};
  const Known known{std::nullopt, Pose2{}, Pose2{2, 0, 0}, std::nullopt};
  const auto doubled = noisier_odometry(odometry, known, 2.0);
  expect_near(geometry::between(doubled[0], doubled[1]),
              geometry::between(odometry[0], odometry[1]));
  expect_near(geometry::between(doubled[2], doubled[3]),
              geometry::between(odometry[2], odometry[3]));
}

TEST(NoisierOdometry, ARobotThatStandsStillGivesNoError) {
  const std::vector<Pose2> odometry(3);
  const Known known{Pose2{}, std::nullopt, Pose2{}};
  for (const Pose2& pose : noisier_odometry(odometry, known, 4.0)) expect_near(pose, {});
}

TEST(NoisierOdometry, BadArgumentsAreErrors) {
  const std::vector<Pose2> odometry(3);
  const Known known{Pose2{}, Pose2{}, Pose2{}};
  EXPECT_THROW(noisier_odometry(odometry, Known{Pose2{}, Pose2{}}, 1.0), std::invalid_argument);
  EXPECT_THROW(noisier_odometry(odometry, Known(3), 1.0), std::invalid_argument);
  EXPECT_THROW(noisier_odometry(odometry, known, -1.0), std::invalid_argument);
  EXPECT_THROW(noisier_odometry(odometry, known, std::nan("")), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::simulation
