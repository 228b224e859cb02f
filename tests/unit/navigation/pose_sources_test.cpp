#include "pose_sources.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "topogeo/navigation/path_follower.hpp"

#include "post_scan.hpp"
#include "test_drive.hpp"

namespace topogeo::navigation {
namespace {

PoseFix tracked_fix(std::int64_t stamp_ns) {
  PoseFix fix;
  fix.stamp_ns = stamp_ns;
  fix.T_map_robot = {2.0, 3.0, 0.0};
  fix.tracking = true;
  return fix;
}

TEST(PoseSources, ALocalizersFixIsThePose) {
  const NavigatorConfig config;
  PoseSources poses{config};
  poses.add(OdometrySample{kSecond_ns, {}});
  EXPECT_FALSE(poses.keeper().good_pose(kSecond_ns));
  poses.add(tracked_fix(kSecond_ns));
  EXPECT_FALSE(poses.update(true, kSecond_ns));
  const auto pose = poses.keeper().good_pose(kSecond_ns);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->x_m, 2.0, 1e-9);
  EXPECT_FALSE(poses.must_stand(true, 1.0, kSecond_ns));
}

class MarkovPoseSources : public testing::Test {
 protected:
  static NavigatorConfig markov_config() {
    NavigatorConfig config;
    config.pose_source = PoseSource::kMarkov;
    config.markov.grid = MarkovGrid::kPositions;
    config.markov_by_laser = true;
    return config;
  }
  void add_scan(std::int64_t stamp_ns) {
    poses.add(OdometrySample{stamp_ns, {}});
    ScanPoints scan;  // the walls of the room, seen from 2, 3
    scan.stamp_ns = stamp_ns;
    scan.points_m = {{6.0, 0.0}, {0.0, 3.0}, {0.0, -3.0}};
    poses.add(scan);
  }

  std::shared_ptr<const planning::HybridMap> map = map_of(room());
  NavigatorConfig config = markov_config();
  PoseSources poses{config};
};

TEST_F(MarkovPoseSources, TheFirstFixIsTheBaseStation) {
  poses.set_map(map.get());
  add_scan(kSecond_ns);
  poses.update(false, kSecond_ns);
  EXPECT_FALSE(poses.keeper().good_pose(kSecond_ns));
  poses.add(tracked_fix(kSecond_ns));
  poses.update(false, kSecond_ns);
  const auto pose = poses.keeper().good_pose(kSecond_ns);
  ASSERT_TRUE(pose);
  EXPECT_LT((pose->position_m() - Eigen::Vector2d(2.0, 3.0)).norm(), 0.1);
}

// A robot with sonars alone has no other source of its pose.
TEST_F(MarkovPoseSources, TheMapsBaseStationNeedsNoFix) {
  const planning::HybridMap with_station(map->space(), map->zones(),
                                         {{"hall", {1.0, 1.0}}, {"dock", {2.0, 3.0}, 0.0}});
  EXPECT_FALSE(poses.markov_pose());
  poses.set_map(&with_station);
  add_scan(kSecond_ns);
  poses.update(false, kSecond_ns);
  ASSERT_TRUE(poses.markov_pose());
  EXPECT_TRUE(poses.markov_pose()->tracking);
  EXPECT_EQ(poses.markov_pose()->stamp_ns, kSecond_ns);
  EXPECT_LT((poses.markov_pose()->T_map_robot.position_m() - Eigen::Vector2d(2.0, 3.0)).norm(),
            0.1);
}

TEST_F(MarkovPoseSources, StandsAtNodesAndAtTheEndUntilItHasLooked) {
  poses.set_map(map.get());
  add_scan(kSecond_ns);
  poses.add(tracked_fix(kSecond_ns));
  poses.update(false, kSecond_ns);
  poses.update(false, 2 * kSecond_ns);
  const std::vector<Eigen::Vector2d> points_m = {{2.0, 3.0}, {6.0, 3.0}};
  const std::vector<Eigen::Vector2d> nodes_m = {{4.0, 3.1}};
  poses.set_path(straight_path(points_m), nodes_m);
  EXPECT_FALSE(poses.must_stand(false, 1.0, 2 * kSecond_ns));
  EXPECT_TRUE(poses.must_stand(false, 2.1, 2 * kSecond_ns));
  EXPECT_TRUE(poses.must_stand(false, std::nullopt, 2 * kSecond_ns));
  add_scan(2 * kSecond_ns + kSecond_ns / 10);  // it may still be rolling
  EXPECT_FALSE(poses.update(false, 2 * kSecond_ns + kSecond_ns / 10));
  add_scan(3 * kSecond_ns);
  EXPECT_TRUE(poses.update(false, 3 * kSecond_ns));
  EXPECT_FALSE(poses.must_stand(false, 2.2, 3 * kSecond_ns));
  EXPECT_TRUE(poses.must_stand(true, std::nullopt, 3 * kSecond_ns));
}

}  // namespace
}  // namespace topogeo::navigation
