// Drives of a robot of 1.2 x 0.6 m on a drawn floor with doors of 0.9 m, with noise: a short form
// of topogeo_outline_drives.
#include <gtest/gtest.h>

#include "outline_task.hpp"

namespace topogeo::navigation {
namespace {

TEST(OutlineDrive, ArrivesThroughNarrowDoorsWithoutAContact) {
  const world::World floor = world::load_world(TOPOGEO_SOURCE_DIR "/share/worlds/floor.world.yaml");
  for (const std::uint64_t seed : {0U, 1U}) {
    const OutlineTask task = draw_outline_task(floor, seed);
    TestDrive drive(floor, settings_of(task));
    drive.go_to(task.T_goal.position_m(), task.T_goal.theta_rad);
    EXPECT_TRUE(drive.arrives(300.0)) << "drive " << seed << ": " << drive.status().message;
    EXPECT_EQ(drive.robot.collisions(), 0U) << "drive " << seed;
    EXPECT_LT(drive.off_m(), 0.05) << "drive " << seed;
  }
}

TEST(OutlineDrive, StandsWithAReasonWhereItDoesNotFit) {
  OutlineTask task;
  task.T_start = {1.5, 3.0, 0.0};
  task.T_goal = {5.0, 1.5, 1.57};  // across a door
  TestDrive drive(two_doors(), settings_of(task));
  drive.go_to(task.T_goal.position_m(), task.T_goal.theta_rad);
  EXPECT_TRUE(drive.run_until([&] { return drive.halted(HaltReason::kNoRoute); }, 5.0));
  EXPECT_NE(drive.status().message.find("does not fit"), std::string::npos);
  EXPECT_EQ(drive.robot.path_m(), 0.0);
}

}  // namespace
}  // namespace topogeo::navigation
