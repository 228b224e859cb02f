#include "topogeo/pipeline/trajectory_error.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::pipeline {
namespace {

using geometry::Pose2;
using topomap::StampedPose;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// Poses one second apart.
std::vector<StampedPose> poses(const std::vector<Pose2>& list) {
  std::vector<StampedPose> result;
  for (const Pose2& pose : list) {
    const auto i = static_cast<std::int64_t>(result.size());
    result.push_back({static_cast<std::uint64_t>(i), i * kSecond_ns, pose});
  }
  return result;
}

// A cross around its own middle, so that a common shift or turn cannot make up for an error.
const std::vector<Pose2> kCross = {{1, 0, 0}, {0, 1, 0.5}, {-1, 0, 1}, {0, -1, -0.5}};

TEST(TrajectoryErrorTest, TurnedAndShiftedTruthHasNone) {
  const Pose2 T{3.0, -7.0, 2.0};
  std::vector<Pose2> moved;
  moved.reserve(kCross.size());
  for (const Pose2& pose : kCross) moved.push_back(T * pose);

  const TrajectoryError error = trajectory_error(poses(moved), poses(kCross));

  EXPECT_EQ(error.pairs, 4U);
  EXPECT_NEAR(error.rms_m, 0.0, 1e-12);
  EXPECT_NEAR(error.largest_m, 0.0, 1e-12);
  EXPECT_NEAR(error.heading_rad, 0.0, 1e-12);
}

TEST(TrajectoryErrorTest, ScaleIsNotForgiven) {
  // Twice the size: every pose is 1 m too far out, whatever the alignment.
  const auto estimate = poses({{2, 0, 0}, {0, 2, 0.5}, {-2, 0, 1}, {0, -2, -0.5}});

  const TrajectoryError error = trajectory_error(estimate, poses(kCross));

  EXPECT_NEAR(error.rms_m, 1.0, 1e-12);
  EXPECT_NEAR(error.largest_m, 1.0, 1e-12);
}

TEST(TrajectoryErrorTest, RmsAndLargestOfUnequalErrors) {
  // Left and right are 0.3 m too far out, up and down 0.1 m: rms = sqrt((0.09 + 0.01) / 2).
  const auto estimate = poses({{1.3, 0, 0}, {0, 1.1, 0.5}, {-1.3, 0, 1}, {0, -1.1, -0.5}});

  const TrajectoryError error = trajectory_error(estimate, poses(kCross));

  EXPECT_NEAR(error.rms_m, std::sqrt(0.05), 1e-12);
  EXPECT_NEAR(error.largest_m, 0.3, 1e-12);
}

TEST(TrajectoryErrorTest, HeadingIsComparedAfterAlignmentAcrossPi) {
  // Positions agree; headings are off by +0.2 and -0.1 about the jump at pi.
  const double pi = std::numbers::pi;
  const auto truth = poses({{1, 0, pi - 0.1}, {0, 1, -pi + 0.05}, {-1, 0, 0}, {0, -1, 0}});
  const auto estimate = poses({{1, 0, -pi + 0.1}, {0, 1, pi - 0.05}, {-1, 0, 0}, {0, -1, 0}});

  EXPECT_NEAR(trajectory_error(estimate, truth).heading_rad, (0.2 + 0.1) / 4.0, 1e-12);
}

TEST(TrajectoryErrorTest, PairsByNearestTimeWithinTheLimit) {
  const auto truth = poses(kCross);
  // A pose 40 ms late is the partner; an absurd one between the stamps is nobody's.
  std::vector<StampedPose> estimate = poses(kCross);
  for (StampedPose& pose : estimate) pose.stamp_ns += 40'000'000;
  estimate.insert(estimate.begin() + 1, StampedPose{9, kSecond_ns / 2, {100, 100, 0}});

  const TrajectoryError error = trajectory_error(estimate, truth);

  EXPECT_EQ(error.pairs, 4U);
  EXPECT_NEAR(error.rms_m, 0.0, 1e-12);
  EXPECT_THROW((void)trajectory_error(estimate, truth, 39'000'000), std::invalid_argument);
}

TEST(TrajectoryErrorTest, FewerThanThreePairsAreRefused) {
  const auto truth = poses(kCross);
  EXPECT_THROW((void)trajectory_error({}, truth), std::invalid_argument);
  EXPECT_THROW((void)trajectory_error(truth, {}), std::invalid_argument);
  EXPECT_THROW((void)trajectory_error(poses({{0, 0, 0}, {1, 0, 0}}), truth), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::pipeline
