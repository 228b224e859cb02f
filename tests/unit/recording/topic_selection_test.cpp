// Recordings with several robots and lasers: scans and odometry of one robot, of a level laser.
#include <cmath>
#include <functional>
#include <numbers>

#include <gmock/gmock.h>

#include "topogeo/recording/survey.hpp"

#include "message_file.hpp"
#include "recorded_drive.hpp"

namespace topogeo::recording {
namespace {

using testing::Contains;
using testing::HasSubstr;

class TopicSelection : public RecordingFiles {
 protected:
  /// The survey of 40 time steps of a tenth of a second; `step` writes the messages of each.
  Survey survey_of(const std::function<void(MessageFile&, int, std::int64_t)>& step,
                   const TopicChoice& choice = {}) {
    MessageFile file(path("a.mcap"));
    for (int i = 0; i < 40; ++i) step(file, i, (10 + i) * kSecond_ns / 10);
    file.close();
    return survey(path("a.mcap"), choice);
  }
};

void put_tilted(MessageFile& file, const std::string& child, std::int64_t stamp_ns) {
  ros::TransformStamped stated = ros::transform_of("base_link", child, {}, stamp_ns);
  stated.transform_().rotation_().y_(std::sin(0.4));
  stated.transform_().rotation_().z_(0.0);
  stated.transform_().rotation_().w_(std::cos(0.4));
  ros::TFMessage message;
  message.transforms_() = {stated};
  file.transforms(message, "/tf_static", stamp_ns);
}

// Robot 1 has more scans, robot 2 more odometry.
TEST_F(TopicSelection, KeepsToOneRobotByNamespace) {
  const auto drive = [](MessageFile& file, int i, std::int64_t stamp_ns) {
    file.scan(stamp_ns, stamp_ns, ranges_of(i), "/robot1/scan");
    if (i % 2 == 0)
      file.odometry(stamp_ns, stamp_ns, arc_pose(0.1 * i), "base_link", "/robot1/odom");
    if (i % 2 == 0) file.scan(stamp_ns, stamp_ns, ranges_of(i), "/robot2/scan");
    file.odometry(stamp_ns, stamp_ns, {}, "base_link", "/robot2/odom");
    file.transform("base_link", "laser", {0.2, 0.0, 0.0}, stamp_ns, "/robot1/tf_static");
    file.transform("base_link", "laser", {-0.4, 0.0, 0.0}, stamp_ns, "/robot2/tf_static");
  };
  const Survey first = survey_of(drive);
  EXPECT_EQ(first.scan_topic, "/robot1/scan");
  EXPECT_EQ(first.odometry_topic, "/robot1/odom");
  ASSERT_TRUE(first.mounting);
  EXPECT_EQ(first.mounting->T_robot_laser, (geometry::Pose2{0.2, 0.0, 0.0}));
  EXPECT_THAT(first.notes, Contains(HasSubstr("not /robot2/scan (20); --scan-topic chooses")));
  TopicChoice second;
  second.scan = "/robot2/scan";
  const Survey other = survey_of(drive, second);
  EXPECT_EQ(other.odometry_topic, "/robot2/odom");
  EXPECT_EQ(other.mounting->T_robot_laser, (geometry::Pose2{-0.4, 0.0, 0.0}));
}

TEST_F(TopicSelection, KeepsToOneRobotByFrames) {
  const Survey facts = survey_of([](MessageFile& file, int i, std::int64_t stamp_ns) {
    file.scan(stamp_ns, stamp_ns, ranges_of(i), "/scan", "robot1/laser");
    file.odometry(stamp_ns, stamp_ns, {}, "robot2/base_link", "/odom", "robot2/odom");
    if (i % 2 == 0) {
      file.odometry(stamp_ns, stamp_ns, arc_pose(0.1 * i), "robot1/base_link", "/odom",
                    "robot1/odom");
    }
  });
  EXPECT_EQ(facts.odom_frame, "robot1/odom");
  EXPECT_EQ(facts.robot_frame, "robot1/base_link");
  const std::vector<scan::Scan> scans = read_scans(path("a.mcap"));
  ASSERT_GE(scans.size(), 39U);
  EXPECT_LT(geometry::difference(scans[20].T_odom_robot, arc_pose(2.0)).norm(), 1e-6);
}

TEST_F(TopicSelection, UsesTheOdometryOfAnotherRobotForNoScans) {
  const auto drive = [](MessageFile& file, int i, std::int64_t stamp_ns) {
    file.scan(stamp_ns, stamp_ns, ranges_of(i), "/scan", "robot1/laser");
    if (i % 4 == 0) file.scan(stamp_ns, stamp_ns, ranges_of(i), "/scan2", "robot2/laser");
    file.odometry(stamp_ns, stamp_ns, {}, "robot2/base_link", "/odom", "robot2/odom");
  };
  EXPECT_EQ(survey_of(drive).scan_topic, "/scan2");
  TopicChoice first;
  first.scan = "/scan";
  EXPECT_THROW((void)survey_of(drive, first), std::runtime_error);
}

// The prefix is that of a sensor.
TEST_F(TopicSelection, TakesOdometryWithOtherPrefixesOfTheOnlyRobot) {
  const Survey facts = survey_of([](MessageFile& file, int i, std::int64_t stamp_ns) {
    file.scan(stamp_ns, stamp_ns, ranges_of(i), "/sensors/scan", "lidar/optical");
    file.odometry(stamp_ns, stamp_ns, arc_pose(0.1 * i), "vehicle/base", "/wheels/odom");
  });
  EXPECT_EQ(facts.odometry_topic, "/wheels/odom");
}

// The tilted laser has a few messages more, and so has the one that looks back.
TEST_F(TopicSelection, PrefersALevelLaserThatLooksForward) {
  const Survey facts = survey_of([](MessageFile& file, int i, std::int64_t stamp_ns) {
    for (int more = 0; more < (i == 0 ? 3 : 1); ++more) {
      file.scan(stamp_ns, stamp_ns, ranges_of(i), "/a_tilted", "tilted");
      file.scan(stamp_ns, stamp_ns, ranges_of(i), "/b_rear", "rear");
    }
    file.scan(stamp_ns, stamp_ns, ranges_of(i), "/c_front", "front");
    if (i % 10 == 0) file.scan(stamp_ns, stamp_ns, ranges_of(i), "/d_rare", "front");
    file.odometry(stamp_ns, stamp_ns, arc_pose(0.1 * i));
    put_tilted(file, "tilted", stamp_ns);
    file.transform("base_link", "rear", {-0.2, 0.0, std::numbers::pi}, stamp_ns);
    file.transform("base_link", "front", {0.2, 0.0, 0.0}, stamp_ns);
  });
  EXPECT_EQ(facts.scan_topic, "/c_front");
  EXPECT_THAT(facts.notes, Contains(HasSubstr("/a_tilted (42)")));
}

TEST_F(TopicSelection, TakesTheFrameOfMostScans) {
  const auto file = [](MessageFile& out, int i, std::int64_t stamp_ns) {
    out.scan(stamp_ns, stamp_ns, ranges_of(i), "/scan", i < 4 ? "rear" : "front");
    out.odometry(stamp_ns, stamp_ns, arc_pose(0.1 * i));
  };
  const Survey facts = survey_of(file);
  EXPECT_EQ(facts.laser_frame, "front");
  EXPECT_THAT(facts.notes,
              Contains(HasSubstr("/scan in frame front (36), not /scan in frame rear (4)")));
  EXPECT_EQ(read_scans(path("a.mcap")).size(), 36U);
}

TEST_F(TopicSelection, NamesTheNodeThatMakesScansOfOtherData) {
  const auto error_with = [&](const std::string& type) -> std::string {
    const std::filesystem::path file = path("a.db3");
    std::filesystem::remove(file);
    const std::unique_ptr<MessageSink> sink = create_sink(file, "none");
    const std::vector<std::byte> content(8);
    sink->write({"/echoes", type, kSecond_ns, content});
    sink->close();
    try {
      (void)survey(file, {});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_THAT(error_with("sensor_msgs/msg/MultiEchoLaserScan"),
              HasSubstr("play it with the node laser_proc, which makes scans of /echoes"));
  EXPECT_THAT(error_with("sensor_msgs/msg/PointCloud2"), HasSubstr("pointcloud_to_laserscan"));
  EXPECT_THAT(error_with("sensor_msgs/msg/Imu"), testing::Not(HasSubstr("play it")));
}

TEST_F(TopicSelection, NamesTheTopicsOfLasersInAnError) {
  const auto drive = [](MessageFile& file, int i, std::int64_t stamp_ns) {
    file.scan(stamp_ns, stamp_ns, ranges_of(i), "/base_scan");
    file.odometry(stamp_ns, stamp_ns, arc_pose(0.1 * i));
  };
  TopicChoice wrong;
  wrong.scan = "/scan";
  std::string error;
  try {
    (void)survey_of(drive, wrong);
  } catch (const std::runtime_error& caught) {
    error = caught.what();
  }
  EXPECT_THAT(error, HasSubstr("expected laser scans (sensor_msgs/LaserScan) on /scan"));
  EXPECT_THAT(error, HasSubstr("scans are on /base_scan (40)"));
}

}  // namespace
}  // namespace topogeo::recording
