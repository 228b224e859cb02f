// Our files in other readers, and theirs in ours: rosbag (Debian's python3-rosbag), @mcap/core and
// @foxglove/rosmsg2-serialization (npm). Each is skipped with a message when the program or the
// network is missing.
#include <cstdlib>

#include <gmock/gmock.h>

#include "fast_cdr.hpp"
#include "named_fields.hpp"
#include "recorded_drive.hpp"

namespace topogeo::recording {
namespace {

class OtherReaders : public RecordingFiles {
 protected:
  /// Runs a script beside this file with the arguments; its exit code, 77 when something that it
  /// needs is missing.
  int run(const std::string& program, const std::string& script, const std::string& arguments) {
    const std::string command = "timeout 100 " + program +
                                " " TOPOGEO_SOURCE_DIR "/tests/unit/recording/" + script + " " +
                                arguments + " > " + path("output").string() + " 2>&1";
    const int status =
        std::system(command.c_str());  // NOLINT(bugprone-command-processor,cert-env33-c)
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  [[nodiscard]] std::string output() const { return bytes_of(path("output")); }

  int fetch_packages() { return run("bash", "fetch_packages.sh", packages_); }

  const std::string packages_ = TOPOGEO_BIN "/../npm_recording";
};

constexpr int kMissing = 77;

/// A line for ros_definitions_check.mjs: a message with all fields filled, encoded as for DDS.
template <typename Message>
std::string filled_line(const std::string& type) {
  Message message;
  for_each_field(FieldFiller(), message);
  std::string bytes;
  using eprosima::fastcdr::Cdr;
  for (const std::byte byte : by_fast_cdr(message, Cdr::LITTLE_ENDIANNESS)) {
    constexpr const char* kDigits = "0123456789abcdef";
    bytes += kDigits[std::to_integer<unsigned>(byte) >> 4U];
    bytes += kDigits[std::to_integer<unsigned>(byte) & 15U];
  }
  const nlohmann::json line = {{"type", type}, {"bytes", bytes}, {"fields", json_of(message)}};
  return line.dump() + "\n";
}

TEST_F(OtherReaders, RosbagReadsOurBagsAndWritesSomeForUs) {
  for (const char* compression : {"none", "bz2", "lz4"}) {
    SCOPED_TRACE(compression);
    const auto file = write_drive(path(std::string(compression) + ".bag"), compression);
    const auto theirs = path(std::string(compression) + "_theirs.bag");
    const int result = run("/usr/bin/python3", "rosbag_check.py",
                           file.string() + " " + theirs.string() + " " + compression);
    if (result == kMissing) GTEST_SKIP() << output();
    ASSERT_EQ(result, 0) << output();
    expect_same_scans(read_scans(theirs), read_scans(file));
  }
}

TEST_F(OtherReaders, McapCoreReadsOursAndWritesSomeForUs) {
  const int fetched = fetch_packages();
  if (fetched == kMissing) GTEST_SKIP() << output();
  ASSERT_EQ(fetched, 0) << output();
  for (const char* compression : {"none", "zstd"}) {
    SCOPED_TRACE(compression);
    const auto file = write_drive(path(std::string(compression) + ".mcap"), compression);
    const auto theirs = path(std::string(compression) + "_theirs.mcap");
    const int result =
        run("node", "mcap_check.mjs", packages_ + " " + file.string() + " " + theirs.string());
    if (result == kMissing) GTEST_SKIP() << output();
    ASSERT_EQ(result, 0) << output();
    expect_same_scans(read_scans(theirs), read_scans(file));
  }
}

// Every type that the bridge and recordings write.
TEST_F(OtherReaders, DecodeOurMessagesByTheDefinitionsOfHumbleAndJazzy) {
  const int fetched = fetch_packages();
  if (fetched == kMissing) GTEST_SKIP() << output();
  ASSERT_EQ(fetched, 0) << output();
  put_bytes(
      path("messages"),
      filled_line<ros::LaserScan>("sensor_msgs/LaserScan") +
          filled_line<ros::Odometry>("nav_msgs/Odometry") +
          filled_line<ros::TFMessage>("tf2_msgs/TFMessage") +
          filled_line<ros::OccupancyGrid>("nav_msgs/OccupancyGrid") +
          filled_line<ros::OccupancyGridUpdate>("map_msgs/OccupancyGridUpdate") +
          filled_line<ros::Path>("nav_msgs/Path") +
          filled_line<ros::PoseStamped>("geometry_msgs/PoseStamped") +
          filled_line<ros::PoseWithCovarianceStamped>("geometry_msgs/PoseWithCovarianceStamped") +
          filled_line<ros::Twist>("geometry_msgs/Twist") +
          filled_line<ros::TwistStamped>("geometry_msgs/TwistStamped") +
          filled_line<ros::MarkerArray>("visualization_msgs/MarkerArray") +
          filled_line<ros::DiagnosticArray>("diagnostic_msgs/DiagnosticArray") +
          filled_line<ros::Clock>("rosgraph_msgs/Clock"));
  const int result =
      run("node", "ros_definitions_check.mjs", packages_ + " " + path("messages").string());
  if (result == kMissing) GTEST_SKIP() << output();
  ASSERT_EQ(result, 0) << output();
  EXPECT_THAT(output(), testing::HasSubstr("26 messages are as they were written"));
}

}  // namespace
}  // namespace topogeo::recording
