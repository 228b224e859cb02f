// One drive in each format, and converted from each to each.
#include "recorded_drive.hpp"

#include <algorithm>

#include <gmock/gmock.h>

#include "topogeo/recording/convert.hpp"
#include "topogeo/recording/message_source.hpp"
#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/ros_conversions/messages.hpp"

#include "compression.hpp"
#include "mcap_sink.hpp"

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
  EXPECT_EQ(LogReader(file).scan_count(), drive.size());
}

// The pipeline gets the same numbers, so maps of all formats are equal to the byte.
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

// rosbag2 records so with the storage MCAP and compression_mode message.
TEST_F(RecordedDrive, OfMessagesThatAreCompressedOneByOneIsRead) {
  const auto file = write_drive(path("a.mcap"));
  {
    McapSink packed(path("b.mcap"), Compression::kNone);
    const auto source = open_messages(file, [](const Topic& /*topic*/) { return true; });
    RawMessage message;
    while (source->next(message)) {
      const Topic& topic = source->topics()[message.topic];
      const std::vector<std::byte> data = compress(message.data, Compression::kZstd);
      packed.write({topic.name, topic.type, message.log_time_ns, data});
    }
    packed.close();
  }
  expect_same_scans(read_scans(path("b.mcap")), read_scans(file));
  EXPECT_EQ(mounting_in_log(path("b.mcap")).T_robot_laser, mounting_in_log(file).T_robot_laser);
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
  const std::vector<scan::Scan> whole = read_scans(write_drive(path("whole.mcap")));
  expect_same_scans(read_scans(path("bag")), whole);  // the recorder was killed
  std::filesystem::rename(path("bag/bag_1.mcap"), path("bag/bag_10.mcap"));
  std::filesystem::rename(path("bag/bag_0.mcap"), path("bag/bag_9.mcap"));
  expect_same_scans(read_scans(path("bag")), whole);
  std::filesystem::rename(path("bag/bag_9.mcap"), path("bag/bag_0.mcap"));
  std::filesystem::rename(path("bag/bag_10.mcap"), path("bag/other_1.mcap"));
  EXPECT_THAT(open_error(path("bag")), HasSubstr("got bag_0.mcap and other_1.mcap"));
  std::filesystem::rename(path("bag/other_1.mcap"), path("bag/bag_1.mcap"));
  std::filesystem::create_directories(path("empty"));
  EXPECT_THAT(open_error(path("empty")), HasSubstr("expected a folder of rosbag2"));
  put_bytes(path("bag/metadata.yaml"),
            "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n"
            "  relative_file_paths:\n    - bag_0.mcap\n    - bag_1.mcap\n");
  expect_same_scans(read_scans(path("bag")), whole);
  // Packed by the recorder, unpacked by hand.
  put_bytes(path("bag/metadata.yaml"),
            "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n"
            "  relative_file_paths:\n    - bag_0.mcap.zstd\n    - bag_1.mcap.zstd\n");
  expect_same_scans(read_scans(path("bag")), whole);
}

// A folder without an ending in its name, like that of `ros2 bag`.
TEST_F(RecordedDrive, IsWrittenAsAFolder) {
  for (const char* name : {"bag", "other/"}) {
    SCOPED_TRACE(name);
    expect_same_scans(read_scans(write_drive(path(name))), read_scans(write_drive(path("a.db3"))));
  }
  EXPECT_TRUE(std::filesystem::exists(path("other/other_0.db3")));
  const std::string metadata = bytes_of(path("bag/metadata.yaml"));
  for (const char* line :
       {"rosbag2_bagfile_information:\n", "  version: 5\n", "  storage_identifier: sqlite3\n",
        "  message_count: 61\n", "    nanoseconds_since_epoch: 1600000000123456789\n",
        "    nanoseconds: 1900000000\n", "    - bag_0.db3\n"}) {
    EXPECT_THAT(metadata, HasSubstr(line));
  }
  EXPECT_THROW(write_drive(path("bag")), std::runtime_error);  // it is not empty
}

TEST_F(RecordedDrive, IsChosenByTopic) {
  const auto file = write_drive(path("a.mcap"));
  EXPECT_THAT(
      open_error(file, {.scan = "/front", .odometry = {}}),
      testing::AllOf(HasSubstr("on /front"), HasSubstr("/scan (sensor_msgs/msg/LaserScan)")));
  EXPECT_THAT(open_error(file, {.scan = {}, .odometry = "/wheels"}), HasSubstr("on /wheels"));
  // Transforms give the same poses as the odometry beside them.
  expect_same_scans(read_scans(file, {.scan = "/scan", .odometry = "/tf"}), read_scans(file));
}

TEST_F(RecordedDrive, HoldsPosesAndTheGraph) {
  const scan::Scan at = short_drive()[3];
  const geometry::Pose2 T_map_robot{5.0, 6.0, 1.0};
  {
    LogWriter writer(path("a.mcap"), kMounting);
    EXPECT_TRUE(writer.holds_poses());
    EXPECT_FALSE(LogWriter(path("a.bag")).holds_poses());
    EXPECT_FALSE(LogWriter(path("a.clf")).holds_poses());
    for (const scan::Scan& scan : short_drive()) writer.write(scan);
    writer.write_pose(at, T_map_robot, Eigen::Vector3d(1.0, 2.0, 3.0).asDiagonal());
    writer.write_grid(at.stamp_ns, {2, 3, 0.5, {1.0, 2.0, 0.1}}, {0, 100, -1, 0, 0, 100});
    writer.write_graph(at.stamp_ns, {{{7, {1.0, 2.0}}}, {{8, false, {{1.0, 2.0}, {3.0, 4.0}}}}});
    writer.close();
  }
  const auto source = open_messages(path("a.mcap"), [](const Topic& topic) {
    return topic.name == "/pose" || topic.name == "/graph" || topic.name == "/map" ||
           topic.name == "/tf";
  });
  std::map<std::string, int> counts;
  RawMessage message;
  ros::TransformStamped last;
  while (source->next(message)) {
    const Topic& topic = source->topics()[message.topic];
    ++counts[topic.name];
    if (topic.name == "/tf") {
      last = decode<ros::TFMessage>(message.data, topic.encoding).transforms_().front();
    } else if (topic.name == "/pose") {
      const auto pose = decode<ros::PoseWithCovarianceStamped>(message.data, topic.encoding);
      EXPECT_EQ(pose.header_().frame_id_(), "map");
      EXPECT_EQ(ros::stamp_ns_of(pose.header_().stamp_()), at.stamp_ns);
      EXPECT_EQ(pose.pose_().pose_().position_().x_(), 5.0);
      EXPECT_EQ(pose.pose_().covariance_()[0], 1.0);
      EXPECT_EQ(pose.pose_().covariance_()[7], 2.0);
      EXPECT_EQ(pose.pose_().covariance_()[35], 3.0);
    } else if (topic.name == "/map") {
      const auto grid = decode<ros::OccupancyGrid>(message.data, topic.encoding);
      EXPECT_EQ(grid.info_().width_(), 2U);
      EXPECT_EQ(grid.info_().height_(), 3U);
      EXPECT_EQ(grid.info_().resolution_(), 0.5F);
      EXPECT_EQ(grid.info_().origin_().position_().y_(), 2.0);
      EXPECT_THAT(grid.data_(), testing::ElementsAre(0, 100, -1, 0, 0, 100));
    } else {
      const auto graph = decode<ros::MarkerArray>(message.data, topic.encoding);
      ASSERT_EQ(graph.markers_().size(), 3U);
      EXPECT_EQ(graph.markers_()[0].action_(), 3);  // clears earlier markers
      EXPECT_EQ(graph.markers_()[1].pose_().position_().y_(), 2.0);
      EXPECT_EQ(graph.markers_()[2].points_().size(), 2U);
    }
  }
  EXPECT_EQ(counts["/pose"], 1);
  EXPECT_EQ(counts["/graph"], 1);
  EXPECT_EQ(counts["/map"], 1);
  // T_map_odom maps the scan's odometry to the pose in the map.
  EXPECT_EQ(last.header_().frame_id_(), "map");
  const geometry::Pose2 T_map_odom = *ros::planar(last.transform_());
  const geometry::Pose2 back = T_map_odom * at.T_odom_robot;
  EXPECT_NEAR(back.x_m, T_map_robot.x_m, 1e-12);
  EXPECT_NEAR(back.y_m, T_map_robot.y_m, 1e-12);
  EXPECT_NEAR(back.theta_rad, T_map_robot.theta_rad, 1e-12);
}

TEST_F(RecordedDrive, IsRefusedWithoutACompressionOfThatName) {
  EXPECT_THROW(LogWriter(path("a.mcap"), {}, "bz2"), std::invalid_argument);
  EXPECT_THROW(LogWriter(path("a.bag"), {}, "gzip"), std::invalid_argument);
  EXPECT_THROW(convert(write_drive(path("a.db3")), path("a.db3")), std::runtime_error);
}

TEST_F(RecordedDrive, IsRefusedUnderANameThatSelectsNoFormat) {
  const auto file = write_drive(path("a.mcap"));
  for (const char* name : {"b.foo", "b.MCAP", "b.mcap.gz", "b.clf.zst", "b.clf~", "b.1", "b."}) {
    SCOPED_TRACE(name);
    EXPECT_THAT(check_log_name(path(name)),
                testing::AllOf(HasSubstr(path(name).string() + ": expected"), HasSubstr(".mcap"),
                               HasSubstr(".db3"), HasSubstr(".bag"), HasSubstr("CARMEN"),
                               HasSubstr("rosbag2")));
    EXPECT_THROW(LogWriter(path(name), kMounting), std::invalid_argument);
    EXPECT_THROW(convert(file, path(name)), std::invalid_argument);
    EXPECT_FALSE(std::filesystem::exists(path(name)));
  }
  for (const char* name : {"b.mcap", "b.db3", "b.bag", "b.clf", "b.log", "b.clf.gz", "b.1.log.gz",
                           "b.gz", "b", "b.1/", "b.1/b"}) {
    EXPECT_THAT(check_log_name(path(name)), testing::IsEmpty());
  }
}

TEST_F(RecordedDrive, OfALaserUpsideDownIsMirroredInEveryFormat) {
  const std::vector<scan::Scan> drive = short_drive();
  TopicChoice choice;
  choice.upside_down = true;
  for (const char* name : {"a.clf", "a.bag", "a.mcap"}) {
    const auto file = write_drive(path(name));
    const std::vector<scan::Scan> scans = read_scans(file, choice);
    ASSERT_EQ(scans.size(), drive.size()) << name;
    for (std::size_t i = 0; i < scans.size(); ++i) {
      EXPECT_EQ(scans[i].angle_min_rad, -0.75) << name;  // that of the last beam, mirrored
      std::vector<float> ranges_m = drive[i].ranges_m;
      std::ranges::reverse(ranges_m);
      EXPECT_EQ(scans[i].ranges_m, ranges_m) << name;
    }
    EXPECT_EQ(mounting_in_log(file, choice).T_robot_laser, kMounting) << name;
  }
}

// A recorder that does not know the types writes * for their sums.
TEST_F(RecordedDrive, OfABagWithoutSumsOfMessagesIsRead) {
  std::string bytes = bytes_of(write_drive(path("a.bag"), "none"));
  const std::string name = "md5sum=";
  constexpr std::size_t kField = 4 + 7 + 32;  // length, name, digits
  std::string any("\x08\0\0\0md5sum=*\x1b\0\0\0", 16);
  any += "x=" + std::string(25, '-');
  std::size_t found = 0;
  for (std::size_t at = bytes.find(name); at != std::string::npos; at = bytes.find(name, at + 7)) {
    bytes.replace(at - 4, kField, any);
    ++found;
  }
  EXPECT_GE(found, 3U);
  put_bytes(path("b.bag"), bytes);
  expect_same_scans(read_scans(path("b.bag")), read_scans(path("a.bag")));
}

TEST_F(RecordedDrive, TakesOutADelayOfTheScans) {
  const auto file = write_drive(path("a.mcap"));
  const std::vector<scan::Scan> as_stated = read_scans(file);
  TopicChoice late;
  late.scan_delay_s = 0.05;
  const std::vector<scan::Scan> corrected = read_scans(file, late);
  ASSERT_EQ(corrected.size(), as_stated.size());
  for (std::size_t i = 1; i < corrected.size(); ++i) {
    EXPECT_EQ(corrected[i].stamp_ns, as_stated[i].stamp_ns - 50'000'000);
    const double halfway_rad =
        0.5 * (as_stated[i - 1].T_odom_robot.theta_rad + as_stated[i].T_odom_robot.theta_rad);
    EXPECT_NEAR(corrected[i].T_odom_robot.theta_rad, halfway_rad, 1e-6);
    EXPECT_EQ(corrected[i].ranges_m, as_stated[i].ranges_m);
  }
}

TEST_F(RecordedDrive, ConvertsRangesOfAnotherScale) {
  for (const char* name : {"a.mcap", "a.clf.gz"}) {
    const auto file = write_drive(path(name));
    scan::CarmenLogOptions half;
    half.range_scale = 0.5;
    LogReader reader(file, half);
    for (const scan::Scan& as_recorded : read_scans(file)) {
      const std::optional<scan::Scan> scan = reader.next();
      ASSERT_TRUE(scan) << name;
      for (std::size_t beam = 0; beam < scan->ranges_m.size(); ++beam) {
        EXPECT_EQ(scan->ranges_m[beam], 0.5F * as_recorded.ranges_m[beam]);
      }
      EXPECT_EQ(scan->T_odom_robot, as_recorded.T_odom_robot);
    }
  }
}

}  // namespace
}  // namespace topogeo::recording
