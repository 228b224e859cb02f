// topogeo goto with a real navigator, and a robot and a planner in this process.
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "navigator_fixture.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;

const Eigen::Vector2d kNorthGoal_m(3.5, 1.0);  // the robot starts at (1, 1), heading along x

class GotoCommand : public NavigatorOnRobot {
 protected:
  std::vector<std::string> words(const std::string& target) {
    return {"goto",     target,           "--domain", domain_,      "--partition",
            kPartition, "--wait-seconds", "600",      "--patience", "600"};
  }
};

TEST_F(GotoCommand, EndsWithZeroWhenTheRobotIsThere) {
  start();
  pretend_planner();
  std::vector<std::string> words = this->words("3.5,1");
  words.insert(words.end(), {"--picture", scratch_ / "way.png"});
  Program command(scratch_, "topogeo", words);
  EXPECT_EQ(wait_for_end(command), 0) << command.err();
  EXPECT_THAT(command.err(), HasSubstr("arrived"));
  EXPECT_LT((robot_.T_world_robot().position_m() - kNorthGoal_m).norm(), 0.1);
  EXPECT_TRUE(std::filesystem::exists(scratch_ / "way.png"));
}

TEST_F(GotoCommand, AnUnknownPlaceIsNamed) {
  start();
  pretend_planner();
  Program command(scratch_, "topogeo", words("room Z"));
  EXPECT_EQ(wait_for_end(command), 1);
  EXPECT_THAT(command.err(), HasSubstr("room Z"));
  EXPECT_TRUE(stands());
}

TEST_F(GotoCommand, CtrlCStopsTheRobot) {
  start();
  pretend_planner();
  Program command(scratch_, "topogeo", words("4.5,1"));
  ASSERT_TRUE(wait_for("the robot to drive", [&] { return rolls(); })) << command.err();
  command.send_signal(SIGINT);
  EXPECT_EQ(wait_for_end(command), 130) << command.err();
  EXPECT_TRUE(
      wait_for("the robot to stand", [&] { return stands() && !is(msg::kNavigatorDriving); }));
  EXPECT_LT(robot_.T_world_robot().x_m, 4.4);
}

TEST_F(GotoCommand, SaysThatNobodyIsThere) {
  Program command(
      scratch_, "topogeo",
      {"goto", "1,1", "--domain", domain_, "--partition", kPartition, "--wait-seconds", "0.5"});
  EXPECT_EQ(command.wait(), 1);
  EXPECT_THAT(command.err(), HasSubstr("no planner and no navigator of robot 'robot' is alive"));
}

}  // namespace
}  // namespace topogeo::test
