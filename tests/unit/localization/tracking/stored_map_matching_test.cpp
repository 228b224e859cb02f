#include "stored_map_matching.hpp"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/matching/matcher.hpp"

#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

/// The room seen from two stops, in the frame of the world.
class StoredMapMatchingTest : public ::testing::Test {
 protected:
  static std::shared_ptr<const StoredMap> room() {
    auto map = std::make_shared<StoredMap>();
    for (std::uint32_t i = 0; i < 2; ++i) {
      const Pose2 T_map_robot{1.0 + i, 1.0, 0.0};
      map->maps.push_back(test::map_at(test::world("room"), T_map_robot, i));
      map->trajectory.stops.push_back({i, 0, T_map_robot, Eigen::Matrix3d::Zero()});
    }
    return map;
  }

  InProcessPool pool_;
  StoredMapMatching matching_{LocalizerConfig{}, room(), pool_};
};

TEST_F(StoredMapMatchingTest, NumbersTheDriveOnFromTheStoredStops) {
  const topomap::LocalMap map = test::map_at(test::world("room"), {1.5, 1.0, 0.0}, 0);
  const DriveStop first = matching_.add(map, 0, std::nullopt);
  EXPECT_EQ(first.map->id, 2U);
  EXPECT_FALSE(first.follows);
  EXPECT_EQ(first.step.distance_m, 0.0);
  EXPECT_GT(first.step.T_before_now.covariance.diagonal().minCoeff(), 0.0);
  const DriveStop second = matching_.add(map, 1, Pose2{1.2, 1.0, 0.0});
  EXPECT_EQ(second.map->id, 3U);
  EXPECT_TRUE(second.follows);
}

TEST_F(StoredMapMatchingTest, AMatchPutsTheRobotWhereItIs) {
  const Pose2 truth{1.5, 1.2, 0.1};
  const DriveStop stop =
      matching_.add(test::map_at(test::world("room"), truth, 0), 0, std::nullopt);
  const UncertainPose predicted{{1.4, 1.1, 0.05}, Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal()};
  const std::vector<MatchCandidate> candidates = matching_.candidates(stop, predicted, 3);
  ASSERT_EQ(candidates.size(), 1U);  // the other stop is next to it
  const MatchTask task = matching_.task(stop, candidates[0].id, predicted);
  EXPECT_EQ(task.reference_map_id, 2U);
  EXPECT_EQ(task.query_map_id, candidates[0].id);
  const std::vector<MatchResult> results = matching_.run({&task, 1});
  ASSERT_EQ(results[0].verdict, Verdict::kAccepted);
  const Pose2 measured = matching_.measured(candidates[0].id, results[0]).T_a_b;
  EXPECT_NEAR(measured.x_m, truth.x_m, 0.05);
  EXPECT_NEAR(measured.y_m, truth.y_m, 0.05);
  EXPECT_NEAR(measured.theta_rad, truth.theta_rad, 0.02);
}

TEST_F(StoredMapMatchingTest, FarFromEveryStoredStopThereIsNoCandidate) {
  const DriveStop stop =
      matching_.add(test::map_at(test::world("room"), {1.5, 1.0, 0.0}, 0), 0, std::nullopt);
  const UncertainPose away{{40.0, 1.0, 0.0}, Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal()};
  EXPECT_TRUE(matching_.candidates(stop, away, 3).empty());
}

TEST_F(StoredMapMatchingTest, RefusesAMapWithoutStops) {
  EXPECT_THROW(StoredMapMatching({}, std::make_shared<const StoredMap>(), pool_),
               std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::localization
