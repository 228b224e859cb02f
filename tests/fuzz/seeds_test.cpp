// The committed seeds through the checks of the fuzzers, with the compiler of the build and without
// libFuzzer.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "checks.hpp"

namespace topogeo::fuzz {
namespace {

std::filesystem::path seeds(const std::string& target) {
  return std::filesystem::path(TOPOGEO_SOURCE_DIR) / "tests/fuzz/seeds" / target;
}

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

template <typename Check>
void expect_all_pass(const std::string& target, const Check& check) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(seeds(target))) {
    paths.push_back(entry.path());
  }
  std::ranges::sort(paths);
  ASSERT_FALSE(paths.empty());
  for (const auto& path : paths) {
    EXPECT_NO_THROW(check(content(path))) << path;
    // Every file that ends early: what a full disk or a cut connection leaves behind.
    const std::string whole = content(path);
    for (std::size_t part = 1; part < 16; ++part) {
      EXPECT_NO_THROW(check(whole.substr(0, part * whole.size() / 16))) << path << " / " << part;
    }
  }
}

TEST(FuzzSeeds, LogsPass) {
  expect_all_pass("carmen_log", [](const std::string& bytes) { check_carmen_log(bytes); });
}

TEST(FuzzSeeds, RecordingsPass) {
  for (const char* target : {"mcap_file", "ros_bag", "rosbag2_sqlite"}) {
    expect_all_pass(target, [](const std::string& bytes) { check_recording(bytes); });
  }
}

TEST(FuzzSeeds, MapFilesPass) {
  expect_all_pass("map_file", [](const std::string& bytes) { check_map_file(bytes); });
}

TEST(FuzzSeeds, LaserBytesPass) {
  expect_all_pass("sick_decoder", [](const std::string& bytes) { check_sick_decoder(bytes); });
  expect_all_pass("laser_driver", [](const std::string& bytes) { check_laser_driver(bytes); });
}

TEST(FuzzSeeds, BaseBytesPass) {
  expect_all_pass("mcp_decoder", [](const std::string& bytes) { check_mcp_decoder(bytes); });
  expect_all_pass("base_driver", [](const std::string& bytes) { check_base_driver(bytes); });
  expect_all_pass("text_base", [](const std::string& bytes) { check_text_base(bytes); });
}

TEST(FuzzSeeds, MessagesPass) {
  expect_all_pass("message", [](const std::string& bytes) { check_message(bytes); });
}

TEST(FuzzSeeds, RosMessagesPass) {
  expect_all_pass("ros_message", [](const std::string& bytes) { check_ros_message(bytes); });
}

TEST(FuzzSeeds, PacketsPass) {
  expect_all_pass("packet", [](const std::string& bytes) { check_packet_parser(bytes); });
}

// The checks are worth something only where the inputs reach the code behind the reader.
TEST(FuzzSeeds, ReachTheMaps) {
  const auto maps = [](const char* name) {
    return check_carmen_log(content(seeds("carmen_log") / name));
  };
  EXPECT_EQ(maps("flaser"), 3U);
  EXPECT_EQ(maps("flaser_gzip"), 3U);
  EXPECT_EQ(maps("robotlaser"), 2U);
  EXPECT_EQ(maps("nothing_usable"), 0U);
  EXPECT_EQ(check_map_file(content(seeds("map_file") / "whole_file")), 2U);
  EXPECT_EQ(check_map_file(content(seeds("map_file") / "body")), 1U);
}

TEST(FuzzSeeds, ReachTheMessages) {
  const auto messages = [](const char* name) { return check_recording(content(seeds("") / name)); };
  EXPECT_EQ(messages("mcap_file/drive_none"), 13U);
  EXPECT_EQ(messages("mcap_file/drive_zstd"), 13U);
  EXPECT_EQ(messages("mcap_file/drive_lz4"), 13U);
  EXPECT_EQ(messages("ros_bag/drive_none"), 13U);
  EXPECT_EQ(messages("ros_bag/drive_bz2"), 13U);
  EXPECT_EQ(messages("rosbag2_sqlite/drive"), 13U);
}

TEST(FuzzSeeds, ReachTheReports) {
  const auto messages = [](const char* name) {
    return check_mcp_decoder(content(seeds("mcp_decoder") / name));
  };
  EXPECT_EQ(messages("ascii"), 15U);
  EXPECT_EQ(messages("binary"), 7U);
  EXPECT_EQ(messages("ascii_bad"), 1U);
  EXPECT_EQ(messages("binary_bad"), 2U);
  EXPECT_EQ(check_text_base(content(seeds("text_base") / "drive")), 10U);
  EXPECT_GT(check_text_base(content(seeds("text_base") / "restart")), 10U);
  EXPECT_EQ(check_text_base(content(seeds("text_base") / "damaged")), 0U);
  EXPECT_EQ(check_base_driver(content(seeds("base_driver") / "create_drive")), 64U);
  EXPECT_GT(check_base_driver(content(seeds("base_driver") / "create_falls")), 20U);
  EXPECT_EQ(check_base_driver(content(seeds("base_driver") / "create_damaged")), 0U);
  EXPECT_EQ(check_base_driver(content(seeds("base_driver") / "kobuki_drive")), 39U);
  EXPECT_GT(check_base_driver(content(seeds("base_driver") / "kobuki_stops")), 20U);
  EXPECT_EQ(check_base_driver(content(seeds("base_driver") / "kobuki_damaged")), 0U);
  EXPECT_EQ(check_base_driver(content(seeds("base_driver") / "pioneer_drive")), 39U);
  EXPECT_GT(check_base_driver(content(seeds("base_driver") / "pioneer_stops")), 20U);
  EXPECT_EQ(check_base_driver(content(seeds("base_driver") / "pioneer_damaged")), 0U);
  EXPECT_EQ(check_base_driver(content(seeds("base_driver") / "roboteq_drive")), 39U);
  EXPECT_EQ(check_base_driver(content(seeds("base_driver") / "roboteq_stops")), 39U);
  EXPECT_EQ(check_base_driver(content(seeds("base_driver") / "roboteq_damaged")), 0U);
  EXPECT_EQ(check_base_driver(content(seeds("base_driver") / "vesc_drive")), 39U);
  EXPECT_EQ(check_base_driver(content(seeds("base_driver") / "vesc_stops")), 39U);
  EXPECT_EQ(check_base_driver(content(seeds("base_driver") / "vesc_damaged")), 0U);
}

TEST(FuzzSeeds, ReachTheTelegrams) {
  const auto telegrams = [](const char* name) {
    return check_sick_decoder(content(seeds("sick_decoder") / name));
  };
  EXPECT_EQ(telegrams("start_up"), 8U);
  EXPECT_EQ(telegrams("late"), 1U);
  EXPECT_EQ(telegrams("false_header"), 2U);
  EXPECT_EQ(telegrams("commands"), 0U);
}

TEST(FuzzSeeds, ReachTheTurns) {
  for (const auto& entry : std::filesystem::directory_iterator(seeds("laser_driver"))) {
    EXPECT_GT(check_laser_driver(content(entry.path())), 0U) << entry.path();
  }
}

TEST(FuzzSeeds, ReachTheSubmessages) {
  for (const auto& entry : std::filesystem::directory_iterator(seeds("packet"))) {
    EXPECT_GT(check_packet_parser(content(entry.path())), 0U) << entry.path();
  }
}

TEST(FuzzSeeds, ReachTheReceiversOfEachTopic) {
  for (const std::string& message : sample_messages()) {
    const std::string topic = message.substr(0, message.find('\n'));
    EXPECT_EQ(check_message(message), 2U) << topic;
    EXPECT_TRUE(std::filesystem::exists(seeds("message") / topic)) << topic;
  }
}

TEST(FuzzSeeds, ReachTheBridgeWithEachTypeOfRos) {
  for (const std::string& message : sample_ros_messages()) {
    const std::string type = message.substr(0, message.find('\n'));
    EXPECT_EQ(check_ros_message(message), 2U) << type;
    EXPECT_EQ(check_ros_message(content(seeds("ros_message") / type)), 2U) << type;
  }
}

TEST(FuzzSeeds, HostileRosMessagesAreRefusedWhereTheyShouldBe) {
  const auto reach = [](const char* name) {
    return check_ros_message(content(seeds("ros_message") / name));
  };
  for (const char* unreadable :
       {"scan_huge_count", "scan_count_of_bytes", "scan_other_encapsulation", "scan_truncated",
        "scan_empty_payload", "tf_huge_count", "tf_count_of_bytes", "twist_truncated"}) {
    EXPECT_EQ(reach(unreadable), 0U) << unreadable;
  }
  for (const char* refused :
       {"scan_no_numbers", "scan_no_beams", "odometry_far", "odometry_fast", "odometry_fast_turn",
        "odometry_no_numbers", "odometry_no_rotation", "tf_long_names", "tf_no_numbers", "goal_far",
        "goal_other_frame", "goal_no_numbers", "pose_far", "twist_sideways", "twist_no_numbers",
        "twist_no_number_besides"}) {
    EXPECT_EQ(reach(refused), 1U) << refused;
  }
  for (const char* taken :
       {"scan_clockwise", "scan_finer", "scan_many_beams", "scan_absurd_ranges", "scan_big_endian",
        "tf_many", "goal_no_rotation", "pose_huge_covariance", "twist_big_endian"}) {
    EXPECT_EQ(reach(taken), 2U) << taken;
  }
}

}  // namespace
}  // namespace topogeo::fuzz
