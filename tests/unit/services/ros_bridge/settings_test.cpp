#include "ros_bridge/settings.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace topogeo::ros_bridge {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

Settings remapped(const std::vector<std::string>& remaps) {
  SettingOptions options;
  options.remaps = remaps;
  return load_settings(options);
}

TEST(RosSettings, NamesAreRelativeToTheNamespaceUnlessTheyBeginWithASlash) {
  SettingOptions options;
  options.ros_namespace = "robot1";
  const Settings settings = load_settings(options);
  EXPECT_EQ(settings.topics.scan, "/robot1/scan");
  EXPECT_EQ(settings.topics.tf, "/tf");
}

TEST(RosSettings, RemapsAsRosDoes) {
  const Settings settings = remapped({"__ns:=/a", "scan:=front/scan", "/tf:=tf", "/a/map:=/floor"});
  EXPECT_EQ(settings.topics.scan, "/a/front/scan");
  EXPECT_EQ(settings.topics.tf, "/a/tf");
  EXPECT_EQ(settings.topics.map, "/floor");
}

TEST(RosSettings, TwoTopicsMayChangePlaces) {
  const Settings settings = remapped({"/pose:=/goal_pose", "/goal_pose:=/pose"});
  EXPECT_EQ(settings.topics.pose, "/goal_pose");
  EXPECT_EQ(settings.topics.goal, "/pose");
}

TEST(RosSettings, SayWhatIsWrong) {
  const auto with = [](const std::string& remap) { return remapped({remap}); };
  EXPECT_THAT([&] { with("/lidar:=/scan"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("no topic /lidar")));
  EXPECT_THAT([&] { with("/scan=/front"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("FROM:=TO")));
  EXPECT_THAT([&] { with("/scan:=/1st/scan"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("starts with a digit")));
}

TEST(RosSettings, AreReadFromAFile) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("ros_settings_test_" + std::to_string(::getpid()) + ".yaml");
  std::ofstream(path) << "topics:\n  scan: /front/scan\nframes:\n  robot: base_footprint\n"
                         "directions:\n  sensors: out\nqos:\n  scan: reliable\n";
  SettingOptions options;
  options.file = path;
  const Settings settings = load_settings(options);
  std::filesystem::remove(path);
  EXPECT_EQ(settings.topics.scan, "/front/scan");
  EXPECT_EQ(settings.frames.robot, "base_footprint");
  EXPECT_EQ(settings.directions.sensors, Direction::kOut);
  EXPECT_EQ(settings.qos.scan, ros::Qos::kReliable);
}

}  // namespace
}  // namespace topogeo::ros_bridge
