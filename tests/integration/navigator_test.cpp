// The navigator as a process: its motion commands, and when it sends none.
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <optional>

#include <gmock/gmock.h>

#include "topogeo/service/conversions.hpp"

#include "join.hpp"
#include "navigator_fixture.hpp"

namespace topogeo::test {
namespace {

const Eigen::Vector2d kGoal_m(3.5, 1.0);  // the robot starts at (1, 1), heading along x

TEST_F(NavigatorOnRobot, DrivesToTheGoalThenLeavesTheBaseToOthers) {
  start();
  send_goal(7, kGoal_m);
  ASSERT_TRUE(
      wait_for("the robot to drive", [&] { return is(msg::kNavigatorDriving) && rolls(); }));
  ASSERT_TRUE(wait_for("the arrival", [&] { return is(msg::kNavigatorArrived); }))
      << status_->message();
  EXPECT_EQ(status_->goal_id(), 7U);
  EXPECT_LT((robot_.T_world_robot().position_m() - kGoal_m).norm(), 0.1);
  EXPECT_EQ(robot_.collisions(), 0U);
  EXPECT_NEAR(status_->driven_m(), 2.5, 0.3);
  ASSERT_TRUE(wait_for("the robot to stand", [&] { return told_to_stand() && stands(); }));
  // The event is the end of the commands: none while five statuses come, in 20 times their period.
  ASSERT_TRUE(wait_for("the commands to end", [&] {
    const std::uint64_t before = commands_;
    const std::uint64_t last = status_->sequence_number();
    return wait_for("five statuses", [&] { return status_->sequence_number() >= last + 5; }) &&
           commands_ == before;
  }));
  EXPECT_TRUE(told_to_stand());
  EXPECT_TRUE(stands());
}

TEST_F(NavigatorOnRobot, StopsWhileThePoseIsLost) {
  start();
  send_goal(1, {4.5, 1.0});
  ASSERT_TRUE(wait_for("the robot to drive", [&] { return rolls(); })) << navigator_->err();
  pose_state_ = msg::kStateLost;
  ASSERT_TRUE(wait_for("the robot to halt as its pose is lost", [&] {
    return halted(msg::kHaltPoseLost) && told_to_stand() && stands();
  })) << status_->message();
  pose_state_ = msg::kStateTracking;
  EXPECT_TRUE(wait_for("the robot to drive on", [&] {
    return rolls() || is(msg::kNavigatorArrived);
  })) << status_->message();
}

// The pose carried on by the previous odometry would be wrong.
TEST_F(NavigatorOnRobot, StandsWhenTheOdometryRestartsUntilANewPose) {
  start();
  send_goal(1, {4.5, 1.0});
  ASSERT_TRUE(wait_for("the robot to drive", [&] { return rolls(); })) << navigator_->err();
  poses_come_ = false;
  ++odometry_epoch_;
  T_odom_start_ = robot_.T_odom_robot();
  ASSERT_TRUE(wait_for("the robot to halt as its pose is lost", [&] {
    return faults("odometry restarted") > 0 && halted(msg::kHaltPoseLost) && stands();
  })) << status_->message();
  EXPECT_EQ(counter("routes"), 1.0) << "the route before the restart is used again";
  poses_come_ = true;
  EXPECT_TRUE(wait_for("the arrival", [&] { return is(msg::kNavigatorArrived); }))
      << status_->message();
  EXPECT_EQ(faults("odometry restarted"), 1U);
}

// A list of goals goes on only after a resume.
TEST_F(NavigatorOnRobot, IsPausedAtItsGoalWhenTheOdometryRestarts) {
  start();
  send_goal(3, kGoal_m);
  ASSERT_TRUE(wait_for("the arrival", [&] { return is(msg::kNavigatorArrived); }));
  send_order(msg::kGoalPause, 3);
  ASSERT_TRUE(wait_for("the pause", [&] { return halted(msg::kHaltPaused); }));
  ++odometry_epoch_;
  T_odom_start_ = robot_.T_odom_robot();
  ASSERT_TRUE(wait_for("the navigator to begin again", [&] { return status_->driven_m() < 1.0; }));
  const std::uint64_t before = status_->sequence_number();
  ASSERT_TRUE(wait_for("ten statuses with the new odometry",
                       [&] { return status_->sequence_number() >= before + 10; }));
  EXPECT_TRUE(is(msg::kNavigatorArrived)) << status_->message();
  EXPECT_TRUE(halted(msg::kHaltPaused)) << status_->message();
  EXPECT_EQ(status_->goal_id(), 3U);
  send_order(msg::kGoalResume, 3);
  EXPECT_TRUE(wait_for("the resume", [&] { return halted(msg::kHaltNone); }));
  ASSERT_TRUE(wait_for("the arrival in the counters", [&] { return counter("arrivals") > 0.0; }));
  EXPECT_EQ(counter("arrivals"), 1.0) << "a pause and new odometry at the goal are no arrivals";
}

// The earlier odometry turns out to be that of the robot.
TEST_F(NavigatorOnRobot, OdometryOfAStrangerStopsItForMomentsOnly) {
  start();
  send_goal(1, {4.5, 1.0});
  ASSERT_TRUE(wait_for("the robot to drive", [&] { return rolls(); })) << navigator_->err();
  odometry_epoch_ = 7;
  ASSERT_TRUE(wait_for("the restart", [&] { return faults("odometry restarted") > 0; }));
  odometry_epoch_ = 0;
  EXPECT_TRUE(wait_for("the arrival", [&] { return is(msg::kNavigatorArrived); }))
      << status_->message();
}

TEST_F(NavigatorOnRobot, PausesResumesAndCancels) {
  start();
  send_goal(5, {4.5, 1.0});
  ASSERT_TRUE(wait_for("the robot to drive", [&] { return rolls(); })) << navigator_->err();
  send_order(msg::kGoalCancel, 99);  // the id of another goal
  send_order(msg::kGoalPause);
  ASSERT_TRUE(wait_for("the robot to pause",
                       [&] { return halted(msg::kHaltPaused) && told_to_stand() && stands(); }));
  EXPECT_EQ(status_->goal_id(), 5U);
  send_order(msg::kGoalResume, 5);
  ASSERT_TRUE(wait_for("the robot to drive on", [&] { return rolls(); })) << status_->message();
  send_order(msg::kGoalCancel, 5);
  ASSERT_TRUE(wait_for("the robot to stand",
                       [&] { return !is(msg::kNavigatorDriving) && told_to_stand() && stands(); }));
  EXPECT_LT(robot_.T_world_robot().x_m, 4.4);
}

/// A robot whose base reports nothing, as one of ROS, and obeys each motion command.
class NavigatorOfASilentBase : public NavigatorOnRobot {
 protected:
  static constexpr std::uint64_t kStop = 17;

  NavigatorOfASilentBase() {
    base_reports_ = false;
    memory_ = scratch_ / "goal";
  }
  void stop_on_the_way() {
    start();
    send_goal(7, {4.5, 1.0});
    ASSERT_TRUE(wait_for("the robot to drive", [&] { return rolls(); })) << navigator_->err();
    send_base_order(msg::kBaseHalt, kStop);
    expect_held();
  }
  /// Waits until the stop keeps the robot from its goal, or has failed to.
  void expect_held() {
    const auto held = [&] {
      return is(msg::kNavigatorStopped) && halted(msg::kHaltBaseNotReady) && told_to_stand() &&
             stands();
    };
    ASSERT_TRUE(
        wait_for("the robot to stand", [&] { return held() || is(msg::kNavigatorArrived); }));
    ASSERT_TRUE(held()) << status_->message();
  }
  void release_and_arrive() {
    send_base_order(msg::kBaseReset, kStop);
    EXPECT_TRUE(wait_for("the arrival", [&] { return is(msg::kNavigatorArrived); }))
        << status_->message();
  }
};

TEST_F(NavigatorOfASilentBase, StandsFromAStopToItsReleaseWhateverGoalIsGiven) {
  ASSERT_NO_FATAL_FAILURE(stop_on_the_way());
  EXPECT_THAT(status_->message().to_string(), testing::HasSubstr("stopped by an operator"));
  send_order(msg::kGoalCancel);
  ASSERT_TRUE(wait_for("the end of the goal", [&] { return is(msg::kNavigatorIdle); }));
  EXPECT_TRUE(wait_for("the stop in the state of the service", [&] {
    return service_status_->message().to_string() ==
           "idle: cancelled: stopped by an operator until the release";
  })) << service_status_->message();
  send_goal(8, kGoal_m);  // as `topogeo goto` does
  ASSERT_TRUE(wait_for("the goal", [&] { return status_->goal_id() == 8; }));
  ASSERT_NO_FATAL_FAILURE(expect_held());
  release_and_arrive();
  EXPECT_EQ(status_->goal_id(), 8U);
}

TEST_F(NavigatorOfASilentBase, StandsInItsNextLifeUntilTheRelease) {
  ASSERT_NO_FATAL_FAILURE(stop_on_the_way());
  restart();
  ASSERT_NO_FATAL_FAILURE(expect_held());
  EXPECT_EQ(status_->goal_id(), 7U);
  release_and_arrive();
}

// The number of the stop is unknown to the command.
TEST_F(NavigatorOfASilentBase, IsReleasedByACommand) {
  ASSERT_NO_FATAL_FAILURE(stop_on_the_way());
  restart();
  ASSERT_NO_FATAL_FAILURE(expect_held());
  Program reset(
      scratch_, "topogeo",
      {"base", "reset", "--domain", domain_, "--partition", kPartition, "--wait-seconds", "600"});
  EXPECT_EQ(wait_for_end(reset), 0) << reset.err();
  EXPECT_THAT(reset.out(), testing::HasSubstr("no base reports its state"));
  EXPECT_TRUE(wait_for("the arrival", [&] { return is(msg::kNavigatorArrived); }))
      << status_->message();
}

TEST_F(NavigatorOfASilentBase, IsHeldByACommand) {
  start();
  send_goal(7, {4.5, 1.0});
  ASSERT_TRUE(wait_for("the robot to drive", [&] { return rolls(); })) << navigator_->err();
  Program halt(
      scratch_, "topogeo",
      {"base", "halt", "--domain", domain_, "--partition", kPartition, "--wait-seconds", "600"});
  EXPECT_EQ(wait_for_end(halt), 0) << halt.err();
  EXPECT_THAT(halt.out(), testing::HasSubstr("holds the robot until the reset"));
  send_goal(8, {1.5, 1.0});
  ASSERT_TRUE(wait_for("the goal", [&] { return status_->goal_id() == 8; }));
  ASSERT_NO_FATAL_FAILURE(expect_held());
}

// A stop while no navigator runs comes only once a page is connected with the next one.
TEST_F(NavigatorOfASilentBase, WaitsInItsNextLifeForAStopThatItMayHaveMissed) {
  start();
  send_goal(7, kGoal_m);
  ASSERT_TRUE(wait_for("the robot to drive", [&] { return rolls(); })) << navigator_->err();
  restart();
  ASSERT_TRUE(wait_for("the arrival", [&] { return is(msg::kNavigatorArrived); }))
      << status_->message();
  EXPECT_THAT(navigator_->err(), testing::HasSubstr("no operator has sent anything"));
}

// The service replaces the navigator within its process.
TEST_F(NavigatorOfASilentBase, StandsWhenTheOdometryRestarts) {
  ASSERT_NO_FATAL_FAILURE(stop_on_the_way());
  ++odometry_epoch_;
  T_odom_start_ = robot_.T_odom_robot();
  ASSERT_TRUE(wait_for("the restart", [&] { return faults("odometry restarted") > 0; }));
  status_.reset();
  ASSERT_NO_FATAL_FAILURE(expect_held());
  release_and_arrive();
}

// The page that sent the goal dies with the navigator.
TEST_F(NavigatorOnRobot, DrivesOnToAGoalWhoseClientIsGoneInItsNextLife) {
  memory_ = scratch_ / "goal";
  start();
  send_goal(7, kGoal_m);
  ASSERT_TRUE(wait_for("the robot to drive", [&] { return rolls(); }));
  navigator_->send_signal(SIGKILL);
  ASSERT_EQ(wait_for_end(*navigator_), 128 + SIGKILL);
  lose_client();
  start();
  EXPECT_TRUE(wait_for("the arrival", [&] { return is(msg::kNavigatorArrived); }))
      << navigator_->err();
  EXPECT_EQ(status_->goal_id(), 7U);
  navigator_->send_signal(SIGKILL);
  ASSERT_EQ(wait_for_end(*navigator_), 128 + SIGKILL);
  start();
  EXPECT_TRUE(is(msg::kNavigatorIdle)) << "the goal has been reached";
}

/// The page, which gave the goal, lives on; a terminal ends once its order is carried out.
class NavigatorBesideClients : public NavigatorOnRobot {
 protected:
  NavigatorBesideClients() { memory_ = scratch_ / "goal"; }

  void set_out() {
    start();
    connect_terminal();
    send_goal(7, {4.5, 1.0});
    ASSERT_TRUE(wait_for("the robot to drive", [&] { return rolls(); })) << navigator_->err();
  }
  void connect_terminal() {
    if (!terminal_) terminal_.emplace(terminal_participant_);
    ASSERT_TRUE(wait_for("the terminal to be connected",
                         [&] { return terminal_->connected_with(navigator_writer_); }));
  }
  void order_from_terminal(msg::GoalKind kind) {
    connect_terminal();
    send_order(*terminal_, kind);
  }
  void pause_from_terminal() {
    order_from_terminal(msg::kGoalPause);
    ASSERT_TRUE(wait_for("the robot to pause",
                         [&] { return halted(msg::kHaltPaused) && told_to_stand() && stands(); }));
    terminal_.reset();
  }

  messaging::Participant terminal_participant_ = join(domain_, kPartition);
  std::optional<messaging::Writer<msg::Goal>> terminal_;
};

TEST_F(NavigatorBesideClients, APauseOutlivesTheNavigatorBesideTheClientOfTheGoal) {
  set_out();
  pause_from_terminal();
  restart();
  expect_silence();
  EXPECT_TRUE(halted(msg::kHaltPaused)) << status_->message();
  EXPECT_EQ(status_->goal_id(), 7U);
  EXPECT_TRUE(stands());
  order_from_terminal(msg::kGoalResume);
  EXPECT_TRUE(wait_for("the arrival", [&] { return is(msg::kNavigatorArrived); }))
      << status_->message();
}

// The page's next goal of a list or of an exploration waits for the resume.
TEST_F(NavigatorBesideClients, APauseAtTheGoalOutlivesTheNavigator) {
  start();
  send_goal(3, kGoal_m);
  ASSERT_TRUE(wait_for("the arrival", [&] { return is(msg::kNavigatorArrived); }));
  send_order(msg::kGoalPause, 3);
  ASSERT_TRUE(wait_for("the pause", [&] { return halted(msg::kHaltPaused); }));
  restart();
  expect_silence();
  EXPECT_TRUE(is(msg::kNavigatorArrived)) << status_->message();
  EXPECT_TRUE(halted(msg::kHaltPaused)) << status_->message();
  EXPECT_EQ(status_->goal_id(), 3U);
  EXPECT_TRUE(stands());
  send_order(msg::kGoalResume, 3);
  ASSERT_TRUE(wait_for("the resume", [&] { return halted(msg::kHaltNone); }));
  EXPECT_EQ(counter("arrivals"), 0.0) << "the arrival was in the previous life";
  restart();
  expect_silence();
  EXPECT_TRUE(is(msg::kNavigatorIdle)) << "the pause has ended";
}

TEST_F(NavigatorBesideClients, AnOldResumeDoesNotUndoALaterPause) {
  set_out();
  pause_from_terminal();
  connect_terminal();
  send_order(msg::kGoalResume);
  ASSERT_TRUE(wait_for("the robot to drive on", [&] { return rolls(); })) << status_->message();
  pause_from_terminal();
  restart();
  expect_silence();
  EXPECT_TRUE(halted(msg::kHaltPaused)) << status_->message();
}

TEST_F(NavigatorBesideClients, ACancelledGoalStaysCancelledInTheNextLife) {
  set_out();
  order_from_terminal(msg::kGoalCancel);
  ASSERT_TRUE(wait_for("the robot to stand",
                       [&] { return is(msg::kNavigatorIdle) && told_to_stand() && stands(); }));
  terminal_.reset();
  restart();
  expect_silence();
  EXPECT_TRUE(is(msg::kNavigatorIdle)) << status_->message();
  EXPECT_EQ(status_->goal_id(), 0U);
  EXPECT_TRUE(stands());
}

// After a reboot of the robot's computer there is no memory, but the client on another one lives.
TEST_F(NavigatorBesideClients, AGoalFromBeforeAColdStartIsDrivenOnlyIfItIsGivenAnew) {
  set_out();
  std::filesystem::remove(memory_);
  restart();
  expect_silence();
  EXPECT_TRUE(is(msg::kNavigatorIdle)) << status_->message();
  ASSERT_TRUE(wait_for("the robot to stand", [&] { return stands(); }));
  send_goal(8, kGoal_m);
  EXPECT_TRUE(wait_for("the arrival", [&] { return is(msg::kNavigatorArrived); }))
      << status_->message();
  EXPECT_EQ(status_->goal_id(), 8U);
}

TEST_F(NavigatorOnRobot, ItsLastCommandIsToStand) {
  start();
  send_goal(1, {4.5, 1.0});
  ASSERT_TRUE(wait_for("the robot to drive", [&] { return rolls(); })) << navigator_->err();
  navigator_->send_signal(SIGTERM);
  EXPECT_EQ(wait_for_end(*navigator_), 0) << navigator_->err();
  EXPECT_TRUE(wait_for("a command to stand", [&] { return told_to_stand(); }));
}

TEST_F(NavigatorOnRobot, WhatIsOfAnotherRobotOrUnusableDrivesNothing) {
  start();
  robot_id_ = "other";  // sensors and pose from here on
  ASSERT_TRUE(wait_for("the sensors of the other robot to be dropped",
                       [&] { return drops("other robot") > 0; }));
  send_goal(1, kGoal_m);
  ASSERT_TRUE(wait_for("the goal to be refused or to wait",
                       [&] { return status_->goal_id() == 1 && !is(msg::kNavigatorDriving); }));
  robot_id_ = "robot";
  EXPECT_TRUE(wait_for("the arrival", [&] { return is(msg::kNavigatorArrived); }))
      << status_->message();
}

TEST_F(NavigatorOnRobot, APoseFromTheFutureDoesNotMakeAllOthersOld) {
  start();
  service::LivePose pose;
  pose.stamp_ns = 8'000'000'000'000'000'000;  // in 2223
  pose.status = {localization::LocalizationState::kTracking, 0.9};
  pose.T_map_robot = robot_.T_world_robot();
  pose.covariance = 1e-4 * Eigen::Matrix3d::Identity();
  ASSERT_TRUE(poses_.write(service::to_msg(pose, "robot")));
  ASSERT_TRUE(wait_for("the pose to be dropped", [&] { return drops("from the future") > 0; }));
  send_goal(1, kGoal_m);
  EXPECT_TRUE(wait_for("the arrival", [&] { return is(msg::kNavigatorArrived); }))
      << status_->message();
}

}  // namespace
}  // namespace topogeo::test
