// The measured motions of a log, from matches and from a reference trajectory.
#include <algorithm>
#include <memory>
#include <set>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "topogeo/calibration/odometry_calibration.hpp"
#include "topogeo/matching/matcher.hpp"
#include "topogeo/slam/pose_graph_slam.hpp"

#include "localization/hand_scenes.hpp"
#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

// Stops a second apart, one metre on, with one scan halfway between each two.
LocalMaps straight_maps(std::uint32_t stops) {
  LocalMaps maps;
  for (std::uint32_t i = 0; i < stops; ++i) {
    topomap::LocalMap map;
    map.id = i;
    map.stamp_ns = i * kSecond_ns;
    map.T_odom_robot = {1.0 * i, 0.0, 0.0};
    if (i > 0) map.track.push_back({0, 0, {1.0 * i - 0.5, 0.0, 0.0}, {}, true});
    maps.push_back(std::make_shared<const topomap::LocalMap>(std::move(map)));
  }
  return maps;
}

topomap::StampedPose at(double time_s, const Pose2& pose) {
  return {0, static_cast<std::int64_t>(time_s * 1e9), pose};
}

TEST(OdometryStretchesTest, GoThroughTheScansBetweenStops) {
  const auto stretches = odometry_stretches(straight_maps(3));
  ASSERT_EQ(stretches.size(), 2U);
  ASSERT_EQ(stretches[1].size(), 2U);
  for (const Pose2& step : stretches[1]) EXPECT_LT(test::distance_m(step, {0.5, 0, 0}), 1e-12);
  EXPECT_TRUE(odometry_stretches({}).empty());
}

TEST(ReferenceMotionsTest, AreThoseUpToTheLongestWay) {
  const std::vector<topomap::StampedPose> reference{at(0, {2.0, 0.0, 1.5}), at(1, {2.0, 1.1, 1.5}),
                                                    at(2, {2.0, 2.2, 1.5}), at(3, {2.0, 3.3, 1.5}),
                                                    at(4, {2.0, 4.4, 1.5})};
  const auto motions = motions_from_reference(straight_maps(5), reference, 2.5);
  ASSERT_EQ(motions.size(), 7U);  // four of 1 m, three of 2 m
  for (const MeasuredMotion& motion : motions) {
    EXPECT_LE(motion.last - motion.first, 2U);
    const Pose2 expected =
        geometry::between(reference[motion.first].pose, reference[motion.last].pose);
    EXPECT_LT(test::distance_m(motion.T_first_last, expected), 1e-12);
    EXPECT_NEAR(motion.covariance(0, 0), 0.02 * 0.02, 1e-6);
    EXPECT_NEAR(motion.covariance(2, 2), 0.0052 * 0.0052, 1e-7);
  }
}

TEST(ReferenceMotionsTest, StopsBetweenTwoPosesAreInterpolatedAndOthersLeftOut) {
  const std::vector<topomap::StampedPose> reference{
      at(0.9, {0.0, 0.0, 0.0}), at(1.1, {0.2, 0.0, 0.1}),   // around stop 1
      at(2.0, {1.1, 0.0, 0.2}),                             // at stop 2
      at(2.6, {1.5, 0.0, 0.2}), at(3.4, {1.9, 0.0, 0.2})};  // too far apart around stop 3
  const auto motions = motions_from_reference(straight_maps(5), reference, 10.0);
  ASSERT_EQ(motions.size(), 1U);
  EXPECT_EQ(motions[0].first, 1U);
  EXPECT_EQ(motions[0].last, 2U);
  const Pose2 expected = geometry::between({0.1, 0.0, 0.05}, reference[2].pose);
  EXPECT_LT(test::distance_m(motions[0].T_first_last, expected), 1e-12);
  EXPECT_LT(test::turn_rad(motions[0].T_first_last, expected), 1e-12);
  EXPECT_TRUE(motions_from_reference(straight_maps(5), {}, 10.0).empty());
}

/// A drive through the room, and the accepted matches of a PoseGraphSlam.
class MatchedMotionsTest : public testing::Test {
 protected:
  MatchedMotionsTest()
      : driven_(test::drive(test::world("room"), {})), pool_(searching_), slam_({}, pool_) {
    for (const auto& map : driven_.maps) slam_.add(map);
    slam_.finish();
  }

  [[nodiscard]] Pose2 truth(std::uint32_t first, std::uint32_t last) const {
    return geometry::between(driven_.T_world_robot[first], driven_.T_world_robot[last]);
  }

  test::DrivenMaps driven_;
  InProcessPool searching_;
  RecordingPool pool_;
  PoseGraphSlam slam_;
};

TEST_F(MatchedMotionsTest, ThePoolHandsOnAndKeepsWhatIsAccepted) {
  EXPECT_EQ(pool_.accepted().size(),
            slam_.counts().reasons[static_cast<std::size_t>(Reason::kNone)]);
  EXPECT_GT(pool_.accepted().size(), driven_.maps.size() / 2);
}

TEST_F(MatchedMotionsTest, AreRightWithoutTheOdometry) {
  const MatchedMotions found =
      motions_from_matches(driven_.maps, pool_.accepted(), slam_.trajectory());
  EXPECT_EQ(found.motions.size() + found.unrefined + found.contradicted, pool_.accepted().size());
  ASSERT_GT(found.motions.size(), pool_.accepted().size() / 2);
  std::vector<double> errors_m;
  for (const MeasuredMotion& motion : found.motions) {
    ASSERT_LT(motion.first, motion.last);
    const Eigen::Vector3d error =
        geometry::difference(motion.T_first_last, truth(motion.first, motion.last));
    errors_m.push_back(error.head<2>().norm());
    // The covariances are generous, so no error is far outside.
    EXPECT_LT(error.dot(motion.covariance.inverse() * error), 16.0)
        << motion.first << " to " << motion.last;
  }
  std::nth_element(errors_m.begin(), errors_m.begin() + static_cast<long>(errors_m.size() / 2),
                   errors_m.end());
  EXPECT_LT(errors_m[errors_m.size() / 2], 0.02);
}

TEST_F(MatchedMotionsTest, AMatchAgainstAllOthersIsLeftOut) {
  const MatchedMotions before =
      motions_from_matches(driven_.maps, pool_.accepted(), slam_.trajectory());
  // Bends the trajectory at one stop, so that the matches of that stop contradict it.
  topomap::Trajectory bent = slam_.trajectory();
  bent.stops[2].T_map_robot.theta_rad += 0.5;
  const MatchedMotions after = motions_from_matches(driven_.maps, pool_.accepted(), bent);
  std::size_t of_stop = 0;
  for (const MeasuredMotion& motion : before.motions) {
    if (motion.first == 2 || motion.last == 2) ++of_stop;
  }
  EXPECT_GT(of_stop, 0U);
  EXPECT_EQ(after.contradicted, before.contradicted + of_stop);
}

}  // namespace
}  // namespace topogeo::localization
