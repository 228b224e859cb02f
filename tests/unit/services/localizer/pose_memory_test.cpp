#include "localizer/pose_memory.hpp"

#include <gtest/gtest.h>

namespace topogeo::localizer {
namespace {

namespace fs = std::filesystem;

class PoseMemoryTest : public testing::Test {
 protected:
  PoseMemoryTest() {
    fs::remove(path_);
    map_.trajectory.stops.resize(2);
    map_.trajectory.stops[1].T_map_robot = {1.0, 2.0, 0.5};
    remembered_.stop = {0xfedcba9876543210ULL, 17};
    remembered_.place.odometry_epoch = 0x0123456789abcdefULL;
    remembered_.place.T_odom_robot = {1.25, -3.5, 2.75};
    remembered_.place.T_map_robot.T_a_b = {4.0, 5.0, -0.25};
    remembered_.place.T_map_robot.covariance << 1.0, 2.0, 3.0, 2.0, 4.0, 5.0, 3.0, 5.0, 6.0;
  }
  ~PoseMemoryTest() override { fs::remove(path_); }

  const fs::path path_ = fs::path(testing::TempDir()) / "topogeo_pose_memory_test";
  localization::StoredMap map_;
  RememberedPlace remembered_;
};

TEST_F(PoseMemoryTest, GivesAnotherProcessTheLastPlace) {
  EXPECT_FALSE(PoseMemory(path_, map_).load());
  PoseMemory(path_, map_).store(remembered_);
  const auto read = PoseMemory(path_, map_).load();
  ASSERT_TRUE(read);
  EXPECT_EQ(read->stop, remembered_.stop);
  EXPECT_EQ(read->place.odometry_epoch, remembered_.place.odometry_epoch);
  EXPECT_EQ(read->place.T_odom_robot, remembered_.place.T_odom_robot);
  EXPECT_EQ(read->place.T_map_robot.T_a_b, remembered_.place.T_map_robot.T_a_b);
  EXPECT_EQ(read->place.T_map_robot.covariance, remembered_.place.T_map_robot.covariance);
}

TEST_F(PoseMemoryTest, APlaceInAnotherMapIsNone) {
  PoseMemory(path_, map_).store(remembered_);
  map_.trajectory.stops[1].T_map_robot.x_m += 0.5;
  EXPECT_FALSE(PoseMemory(path_, map_).load());
}

TEST_F(PoseMemoryTest, WhatWasForgottenIsNotThere) {
  const PoseMemory memory(path_, map_);
  memory.store(remembered_);
  memory.forget();
  EXPECT_FALSE(PoseMemory(path_, map_).load());
}

}  // namespace
}  // namespace topogeo::localizer
