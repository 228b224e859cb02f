// One drive in each format, and from each to each.
#include "recorded_drive.hpp"

#include <gmock/gmock.h>

#include "topogeo/recording/convert.hpp"

namespace topogeo::recording {
namespace {

using testing::HasSubstr;

class RecordedDrive : public RecordingFiles,
                      public testing::WithParamInterface<std::pair<const char*, const char*>> {};

INSTANTIATE_TEST_SUITE_P(Formats, RecordedDrive,
                         testing::Values(std::pair{"a.mcap", "none"}, std::pair{"a.mcap", "zstd"},
                                         std::pair{"a.mcap", "lz4"}, std::pair{"a.db3", "none"},
                                         std::pair{"a.bag", "none"}, std::pair{"a.bag", "lz4"},
                                         std::pair{"a.bag", "bz2"}));

TEST_P(RecordedDrive, ComesBackAsItWas) {
  const auto file = write_drive(path(GetParam().first), GetParam().second);
  const std::vector<scan::Scan> scans = read_scans(file);
  const std::vector<scan::Scan> drive = short_drive();
  ASSERT_EQ(scans.size(), drive.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    EXPECT_EQ(scans[i].stamp_ns, drive[i].stamp_ns);
    EXPECT_EQ(scans[i].angle_min_rad, drive[i].angle_min_rad);
    EXPECT_EQ(scans[i].angle_step_rad, drive[i].angle_step_rad);
    EXPECT_EQ(scans[i].ranges_m, drive[i].ranges_m);
    EXPECT_EQ(scans[i].T_odom_robot.x_m, drive[i].T_odom_robot.x_m);
    EXPECT_NEAR(scans[i].T_odom_robot.theta_rad, drive[i].T_odom_robot.theta_rad, 1e-15);
  }
  const LogMounting mounting = mounting_in_log(file);
  ASSERT_TRUE(mounting.T_robot_laser);
  EXPECT_EQ(*mounting.T_robot_laser, kMounting);
  EXPECT_EQ(count_scans(file), drive.size());
}

// What makes maps of all formats equal to the byte: the pipeline gets the same numbers.
TEST_P(RecordedDrive, GivesTheSameScansInEachFormatItIsConvertedTo) {
  const auto file = write_drive(path(GetParam().first), GetParam().second);
  const std::vector<scan::Scan> scans = read_scans(file);
  for (const char* name : {"b.mcap", "b.db3", "b.bag", "b.clf", "b.clf.gz"}) {
    SCOPED_TRACE(name);
    const Conversion done = convert(file, path(name));
    EXPECT_EQ(done.scans, scans.size());
    expect_same_scans(read_scans(path(name)), scans);
    EXPECT_EQ(mounting_in_log(path(name)).T_robot_laser, mounting_in_log(file).T_robot_laser);
  }
}

TEST_F(RecordedDrive, HasNoFaults) {
  const scan::LogCheck check = check_log(write_drive(path("a.mcap")));
  EXPECT_EQ(check.faults(), 0U);
  EXPECT_EQ(check.scans, 20U);
  EXPECT_NEAR(check.path_m, 3.8, 0.01);
}

TEST_F(RecordedDrive, IsReadFromAFolderOfSeveralFiles) {
  std::filesystem::create_directories(path("bag"));
  {
    const std::vector<scan::Scan> drive = short_drive();
    LogWriter first(path("bag/bag_0.mcap"), kMounting);
    LogWriter second(path("bag/bag_1.mcap"), kMounting);
    for (std::size_t i = 0; i < drive.size(); ++i) (i < 12 ? first : second).write(drive[i]);
    first.close();
    second.close();
  }
  EXPECT_THAT(open_error(path("bag")), HasSubstr("expected a folder of rosbag2"));
  put_bytes(path("bag/metadata.yaml"),
            "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n"
            "  relative_file_paths:\n    - bag_0.mcap\n    - bag_1.mcap\n");
  expect_same_scans(read_scans(path("bag")), read_scans(write_drive(path("whole.mcap"))));
}

TEST_F(RecordedDrive, IsChosenByTopic) {
  const auto file = write_drive(path("a.mcap"));
  EXPECT_THAT(
      open_error(file, {.scan = "/front", .odometry = {}}),
      testing::AllOf(HasSubstr("on /front"), HasSubstr("/scan (sensor_msgs/msg/LaserScan)")));
  EXPECT_THAT(open_error(file, {.scan = {}, .odometry = "/wheels"}), HasSubstr("on /wheels"));
  // Transforms give the same poses as the odometry that they were written with.
  expect_same_scans(read_scans(file, {.scan = "/scan", .odometry = "/tf"}), read_scans(file));
}

TEST_F(RecordedDrive, IsRefusedWithoutACompressionOfThatName) {
  EXPECT_THROW(LogWriter(path("a.mcap"), {}, "bz2"), std::invalid_argument);
  EXPECT_THROW(LogWriter(path("a.bag"), {}, "gzip"), std::invalid_argument);
  EXPECT_THROW(convert(write_drive(path("a.db3")), path("a.db3")), std::runtime_error);
}

}  // namespace
}  // namespace topogeo::recording
