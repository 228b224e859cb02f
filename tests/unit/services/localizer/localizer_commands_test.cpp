#include "localizer/localizer_commands.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/msg/trajectory.h"

namespace topogeo::localizer {
namespace {

using geometry::Pose2;

std::shared_ptr<const topomap::LocalMap> blind_stop(std::uint32_t id) {
  auto map = std::make_shared<topomap::LocalMap>();
  map->robot_id = "robot";
  map->id = id;
  map->points = {{2.0F, 0.0F}, {2.0F, 0.5F}};
  return map;
}

service::LocalizationCommand command_of(std::uint32_t kind) {
  service::LocalizationCommand command;
  command.kind = static_cast<decltype(command.kind)>(kind);
  return command;
}

/// A session that maps its first stop.
class LocalizerCommands : public ::testing::Test {
 protected:
  LocalizerCommands() {
    slam_->add(blind_stop(0));
    now_.stops_in_map = 1;
  }
  CommandAnswer send(std::uint32_t kind) { return carry_out(command_of(kind), now_, slam_); }

  localization::InProcessPool pool_;
  localization::SlamSession slam_{{}, pool_};
  CommandMoment now_;
};

TEST_F(LocalizerCommands, WhileMappingThereIsNoPoseToSetAndNothingToSearch) {
  EXPECT_FALSE(send(msg::kCommandSetPose).accepted);
  EXPECT_FALSE(send(msg::kCommandSearch).accepted);
  const CommandAnswer again = send(msg::kCommandSwitchToMapping);
  EXPECT_FALSE(again.accepted);
  EXPECT_EQ(again.message, "it already extends a map");
}

TEST_F(LocalizerCommands, SwitchesToLocalizationAndBack) {
  const CommandAnswer left = send(msg::kCommandSwitchToLocalization);
  EXPECT_TRUE(left.accepted);
  EXPECT_EQ(left.message, "the map of 1 stops stays unchanged");
  EXPECT_FALSE(slam_.mapping());
  EXPECT_FALSE(send(msg::kCommandSwitchToLocalization).accepted);
  EXPECT_TRUE(send(msg::kCommandSearch).accepted);
  EXPECT_EQ(slam_->status().state, localization::LocalizationState::kSearching);
  EXPECT_TRUE(send(msg::kCommandSetPose).accepted);
  EXPECT_EQ(slam_->status().state, localization::LocalizationState::kAmbiguous);
  EXPECT_TRUE(send(msg::kCommandSwitchToMapping).accepted);
  EXPECT_TRUE(slam_.mapping());
}

TEST_F(LocalizerCommands, NothingSwitchesWithoutAMapOrAfterTheEnd) {
  now_.stops_in_map = 0;
  EXPECT_EQ(send(msg::kCommandSwitchToLocalization).message, "there is no map yet");
  now_ = {true, 1, {}};
  EXPECT_EQ(send(msg::kCommandSwitchToLocalization).message, "the log has ended");
}

TEST_F(LocalizerCommands, APoseIsThatOfNow) {
  service::LocalizationCommand command = command_of(msg::kCommandSetPose);
  command.T_map_robot = {5.0, 1.0, 0.0};
  now_.T_stop_robot = {2.0, 0.0, 0.0};  // driven since the last stop
  const Pose2 stop = stop_pose(command, now_);
  EXPECT_NEAR(stop.x_m, 3.0, 1e-12);
  EXPECT_NEAR(stop.y_m, 1.0, 1e-12);
}

TEST_F(LocalizerCommands, RefusesAnUnknownCommand) {
  const CommandAnswer answer = send(77);
  EXPECT_FALSE(answer.accepted);
  EXPECT_EQ(answer.message, "unknown command");
}

}  // namespace
}  // namespace topogeo::localizer
