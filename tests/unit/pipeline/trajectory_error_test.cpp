#include "topogeo/pipeline/trajectory_error.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "loop_pairs.hpp"

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

// A cross around its own middle, so that a common shift or turn cannot hide an error.
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
  // Twice the size: every pose is 1 m too far out in any alignment.
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
  // Positions agree; headings are off by +0.2 and -0.1 across the jump at pi.
  const double pi = std::numbers::pi;
  const auto truth = poses({{1, 0, pi - 0.1}, {0, 1, -pi + 0.05}, {-1, 0, 0}, {0, -1, 0}});
  const auto estimate = poses({{1, 0, -pi + 0.1}, {0, 1, pi - 0.05}, {-1, 0, 0}, {0, -1, 0}});

  EXPECT_NEAR(trajectory_error(estimate, truth).heading_rad, (0.2 + 0.1) / 4.0, 1e-12);
}

TEST(TrajectoryErrorTest, PairsByNearestTimeWithinTheLimit) {
  const auto truth = poses(kCross);
  // A pose 40 ms late is the partner; an absurd one between the stamps has no partner.
  std::vector<StampedPose> estimate = poses(kCross);
  for (StampedPose& pose : estimate) pose.stamp_ns += 40'000'000;
  estimate.insert(estimate.begin() + 1, StampedPose{9, kSecond_ns / 2, {100, 100, 0}});

  const TrajectoryError error = trajectory_error(estimate, truth);

  EXPECT_EQ(error.pairs, 4U);
  EXPECT_NEAR(error.rms_m, 0.0, 1e-12);
  EXPECT_THROW((void)trajectory_error(estimate, truth, 39'000'000), std::invalid_argument);
}

TEST(TrajectoryErrorTest, TheOrderOfThePosesDoesNotMatter) {
  const auto truth = poses(kCross);
  const auto estimate = poses({{1.3, 0, 0}, {0, 1.1, 0.5}, {-1.3, 0, 1}, {0, -1.1, -0.5}});
  const std::vector<StampedPose> backwards(estimate.rbegin(), estimate.rend());

  const TrajectoryError error = trajectory_error(backwards, truth);

  EXPECT_EQ(error.pairs, 4U);
  EXPECT_EQ(error.end_m, trajectory_error(estimate, truth).end_m);
}

TEST(TrajectoryErrorTest, StepsEndAndShareOfAPathWorkedByHand) {
  // Along x, 1 m a step; the estimate has 1.1 m in the first step and turns by 0.3 rad before the
  // last, which therefore ends at (2.1 + cos 0.3, sin 0.3). The fifth pose has no partner.
  const auto truth = poses({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {9, 9, 0}});
  const double c = std::cos(0.3);
  const double s = std::sin(0.3);
  const auto estimate = poses({{0, 0, 0}, {1.1, 0, 0}, {2.1, 0, 0.3}, {2.1 + c, s, 0.3}});

  const TrajectoryError error = trajectory_error(estimate, truth);

  EXPECT_EQ(error.pairs, 4U);
  EXPECT_DOUBLE_EQ(error.matched, 0.8);
  EXPECT_NEAR(error.path_m, 3.0, 1e-12);
  EXPECT_EQ(error.local.pairs, 3U);
  EXPECT_NEAR(error.local.mean_m, 0.1 / 3.0, 1e-12);
  EXPECT_NEAR(error.local.mean_rad, 0.3 / 3.0, 1e-12);
  EXPECT_NEAR(error.end_m, std::hypot(2.1 + c - 3.0, s), 1e-12);
  EXPECT_FALSE(error.loop);
}

TEST(TrajectoryErrorTest, LoopsAreWhereThePathComesBackAfterTwentyMetres) {
  // 12 m out and back in steps of 1 m.
  std::vector<Pose2> path;
  for (int i = 0; i <= 24; ++i) path.push_back({i <= 12 ? i : 24.0 - i, 0, 0});
  const auto truth = poses(path);
  // Path distance j - i, distance |i - (24 - j)| = |i + j - 24|: over 20 and under 1.5 are (0,23),
  // (0,24), (1,22), (1,23), (1,24), (2,23).
  const std::size_t expected = 6;
  // The estimate is shifted, from pose 20 on, sideways by 0.2 m, the error of every such pair.
  for (std::size_t i = 20; i < path.size(); ++i) path[i].y_m = 0.2;

  const TrajectoryError error = trajectory_error(poses(path), truth);

  ASSERT_TRUE(error.loop);
  EXPECT_EQ(error.loop->pairs, expected);
  EXPECT_NEAR(error.loop->mean_m, 0.2, 1e-12);
  EXPECT_NEAR(error.loop->mean_rad, 0.0, 1e-12);
}

TEST(TrajectoryErrorTest, TheMessageForTooFewPairsNamesBothTimes) {
  auto late = poses(kCross);
  for (StampedPose& pose : late) pose.stamp_ns += 100 * kSecond_ns;
  try {
    (void)trajectory_error(late, poses(kCross));
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "only 0 poses match in time (within 0.05 s), expected at least 3: the estimate "
                 "covers 100.000 to 103.000 s, the reference covers 0.000 to 3.000 s");
  }
}

TEST(TrajectoryErrorTest, FewerThanThreePairsAreRefused) {
  const auto truth = poses(kCross);
  EXPECT_THROW((void)trajectory_error({}, truth), std::invalid_argument);
  EXPECT_THROW((void)trajectory_error(truth, {}), std::invalid_argument);
  EXPECT_THROW((void)trajectory_error(poses({{0, 0, 0}, {1, 0, 0}}), truth), std::invalid_argument);
}

TEST(RelationsErrorTest, MeanAndDeviationOfAllAndOfThoseFarApart) {
  // One pose every 20 s along x, 1 m apart.
  std::vector<StampedPose> estimate;
  estimate.reserve(4);
  for (std::int64_t i = 0; i < 4; ++i) {
    estimate.push_back(
        {static_cast<std::uint64_t>(i), 20 * i * kSecond_ns, {static_cast<double>(i), 0, 0}});
  }
  const auto at = [](double seconds) { return static_cast<std::int64_t>(seconds * 1e9); };
  const std::vector<storage::Relation> relations = {
      {at(0.0), at(20.0), {1.0, 0.1, 0.0}},       // error of 0.1 m
      {at(20.0), at(0.0), {-1.0, 0.0, 0.2}},      // backwards; error of 0.2 rad
      {at(0.0), at(60.0005), {3.0, -0.5, -0.4}},  // half a millisecond off; 0.5 m, 0.4 rad; far
      {at(0.0), at(40.002), {7.0, 7.0, 0.0}},     // no pose within a millisecond
  };

  const RelationsError error = relations_error(estimate, relations);

  EXPECT_EQ(error.given, 4U);
  ASSERT_TRUE(error.all);
  EXPECT_EQ(error.all->pairs, 3U);
  EXPECT_NEAR(error.all->mean_m, 0.2, 1e-12);
  EXPECT_NEAR(error.all->deviation_m, std::sqrt((0.01 + 0.04 + 0.09) / 3.0), 1e-12);
  EXPECT_NEAR(error.all->mean_rad, 0.2, 1e-12);
  EXPECT_NEAR(error.all->deviation_rad, std::sqrt((0.04 + 0.0 + 0.04) / 3.0), 1e-12);
  ASSERT_TRUE(error.far);
  EXPECT_EQ(error.far->pairs, 1U);
  EXPECT_NEAR(error.far->mean_m, 0.5, 1e-12);
  EXPECT_NEAR(error.far->deviation_m, 0.0, 1e-12);
}

TEST(RelationsErrorTest, WithoutUsableRelationsThereIsNoFigure) {
  const std::vector<storage::Relation> relations = {{1, 900 * kSecond_ns, {}}};
  EXPECT_FALSE(relations_error(poses(kCross), relations).all);
  EXPECT_FALSE(relations_error({}, relations).far);
  EXPECT_EQ(relations_error(poses(kCross), {}).given, 0U);
}

// Expected values from Python: l = list(range(10)); random.Random(0).shuffle(l)
TEST(LoopPairsTest, ShufflesAsPythonDoes) {
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i < 10; ++i) pairs.emplace_back(i, i);
  shuffle_as_python(pairs);
  std::vector<std::size_t> order;
  order.reserve(pairs.size());
  for (const IndexPair& pair : pairs) order.push_back(pair.first);
  EXPECT_EQ(order, (std::vector<std::size_t>{7, 8, 1, 5, 3, 4, 2, 0, 9, 6}));
}

// The same for range(5000): its first elements use numbers of the generator's second block.
TEST(LoopPairsTest, ShufflesLongListsAsPythonDoes) {
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i < 5000; ++i) pairs.emplace_back(i, i);
  shuffle_as_python(pairs);
  EXPECT_EQ(pairs[0].first, 2795U);
  EXPECT_EQ(pairs[1].first, 4151U);
  EXPECT_EQ(pairs[4999].first, 3155U);
}

TEST(LoopPairsTest, LongPathsAreThinnedOutAndAtMostTwoThousandPairsTaken) {
  // On the spot, except for a path of 30 m in the middle: pairs of every pose before and after it.
  std::vector<Pose2> path(400);
  path[200] = {15, 0, 0};
  EXPECT_EQ(loop_pairs(path).size(), 2000U);  // of 200 * 199
  path.assign(1000, Pose2{});
  path[500] = {15, 0, 0};
  for (const auto& [i, j] : loop_pairs(path)) {
    EXPECT_EQ(i % 2, 0U);
    EXPECT_EQ((j - i) % 2, 1U);
  }
  EXPECT_TRUE(loop_pairs({}).empty());
}

}  // namespace
}  // namespace topogeo::pipeline
