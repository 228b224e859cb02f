// Recordings without odometry, or with poses of other types in its place.
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/recording/message_source.hpp"
#include "topogeo/recording/ros_codec.hpp"
#include "topogeo/ros_conversions/laser_scan.hpp"

#include "message_file.hpp"
#include "message_sink.hpp"
#include "odometry_message.hpp"
#include "recorded_drive.hpp"

namespace topogeo::recording {
namespace {

using geometry::Pose2;
using ::testing::HasSubstr;

/// Files with the scans of short_drive() and, beside them, one topic of poses.
class RecordedPoses : public RecordingFiles, public testing::WithParamInterface<const char*> {
 protected:
  template <typename Message, typename Fill>
  std::filesystem::path write_poses(std::string_view type, const Fill& fill) {
    std::filesystem::path file = path(GetParam());
    const std::unique_ptr<MessageSink> sink = create_sink(file, "none");
    for (const scan::Scan& scan : short_drive()) {
      Message message;
      if constexpr (!std::same_as<Message, ros::LaserScan>) {
        set_time(scan.stamp_ns, message);
        fill(scan.T_odom_robot, message);
        write(*sink, "/tracker", type, scan.stamp_ns, message);
      }
      ros::LaserScan laser = ros::to_laser_scan(scan, "laser", 50.0F);
      write(*sink, "/scan", kLaserScanType, scan.stamp_ns, laser);
    }
    sink->close();
    return file;
  }
  std::filesystem::path write_scans() {
    return write_poses<ros::LaserScan>(kLaserScanType, [](const Pose2&, ros::LaserScan&) {});
  }

  static void set_turn(double theta_rad, ros::Quaternion& turn) {
    turn.z_(std::sin(0.5 * theta_rad));
    turn.w_(std::cos(0.5 * theta_rad));
  }
  static void set_pose(const Pose2& T, ros::Pose& pose) {
    pose.position_().x_(T.x_m);
    pose.position_().y_(T.y_m);
    set_turn(T.theta_rad, pose.orientation_());
  }

  /// The scans with the poses, which are chosen by name.
  std::vector<scan::Scan> read(const std::filesystem::path& file) {
    return read_scans(file, {.scan = {}, .odometry = "/tracker"});
  }

  static void expect_poses_of_the_drive(const std::vector<scan::Scan>& scans) {
    const std::vector<scan::Scan> drive = short_drive();
    ASSERT_EQ(scans.size(), drive.size());
    for (std::size_t i = 0; i < drive.size(); ++i) {
      EXPECT_LT(geometry::difference(scans[i].T_odom_robot, drive[i].T_odom_robot).norm(), 1e-9);
    }
  }

 private:
  template <typename Message>
  static void set_time(std::int64_t stamp_ns, Message& message) {
    message.header_().stamp_().sec_(static_cast<std::int32_t>(stamp_ns / 1'000'000'000));
    message.header_().stamp_().nanosec_(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000));
    message.header_().frame_id_("room");
  }
  template <typename Message>
  static void write(MessageSink& sink, const std::string& topic, std::string_view type,
                    std::int64_t time_ns, const Message& message) {
    std::vector<std::byte> bytes;
    encode(message, sink.encoding(), bytes);
    sink.write({topic, type, time_ns, bytes});
  }
};

INSTANTIATE_TEST_SUITE_P(Formats, RecordedPoses, testing::Values("a.mcap", "a.db3"));

class RecordedScans : public RecordedPoses {};
INSTANTIATE_TEST_SUITE_P(Formats, RecordedScans, testing::Values("a.mcap", "a.db3", "a.bag"));

TEST_P(RecordedScans, AreRefusedWithoutOdometryUnlessItIsOptional) {
  const auto file = write_scans();
  EXPECT_THAT(open_error(file), HasSubstr("expected odometry"));
  TopicChoice optional;
  optional.odometry_use = OdometryUse::kIfRecorded;
  const std::vector<scan::Scan> scans = read_scans(file, optional);
  ASSERT_EQ(scans.size(), short_drive().size());
  for (const scan::Scan& scan : scans) EXPECT_EQ(scan.T_odom_robot, Pose2{});
  EXPECT_FALSE(LogReader(file, {}, optional).has_odometry());
  optional.odometry = "/wheels";
  EXPECT_THAT(open_error(file, optional), HasSubstr("on /wheels"));
}

TEST_P(RecordedScans, HaveNoOdometryIfNoneOfItsPosesIsUsable) {
  MessageFile file(path(GetParam()));
  for (int i = 0; i < 20; ++i) {
    file.odometry(i * kSecond_ns, i * kSecond_ns, {5e7, 0.0, 0.0});
    file.scan(i * kSecond_ns, i * kSecond_ns, ranges_of(i));
  }
  file.close();
  TopicChoice optional;
  optional.odometry_use = OdometryUse::kIfRecorded;
  LogReader reader(path(GetParam()), {}, optional);
  EXPECT_FALSE(reader.has_odometry());
  EXPECT_THAT(reader.odometry_fault(), HasSubstr("expected an odometry pose within 1e6 m"));
  EXPECT_EQ(read_scans(path(GetParam()), optional).size(), 20U);
  EXPECT_THAT(open_error(path(GetParam())), HasSubstr("none of 20 scans of /scan is usable"));
}

TEST_P(RecordedScans, HaveNoOdometryIfItIsIgnored) {
  TopicChoice ignoring;
  ignoring.odometry_use = OdometryUse::kIgnored;
  const auto file = write_drive(path(GetParam()), "none");
  EXPECT_TRUE(LogReader(file).has_odometry());
  EXPECT_FALSE(LogReader(file, {}, ignoring).has_odometry());
  for (const scan::Scan& scan : read_scans(file, ignoring)) EXPECT_EQ(scan.T_odom_robot, Pose2{});
  // The transforms still state where the laser is.
  EXPECT_EQ(mounting_in_log(file, ignoring).T_robot_laser, kMounting);
}

TEST_P(RecordedPoses, OfATrackingSystemServeAsOdometry) {
  const auto file = write_poses<ros::PoseStamped>(
      "geometry_msgs/msg/PoseStamped",
      [](const Pose2& T, ros::PoseStamped& message) { set_pose(T, message.pose_()); });
  expect_poses_of_the_drive(read(file));
  // Only by name: a goal of navigation has the same type.
  EXPECT_THAT(open_error(file), HasSubstr("expected odometry"));
}

TEST_P(RecordedPoses, WithCovarianceServeAsOdometry) {
  expect_poses_of_the_drive(read(write_poses<ros::PoseWithCovarianceStamped>(
      "geometry_msgs/msg/PoseWithCovarianceStamped",
      [](const Pose2& T, ros::PoseWithCovarianceStamped& message) {
        set_pose(T, message.pose_().pose_());
      })));
}

TEST_P(RecordedPoses, AsTransformsServeAsOdometry) {
  expect_poses_of_the_drive(read(write_poses<ros::TransformStamped>(
      "geometry_msgs/msg/TransformStamped", [](const Pose2& T, ros::TransformStamped& message) {
        message.child_frame_id_("laser");
        message.transform_().translation_().x_(T.x_m);
        message.transform_().translation_().y_(T.y_m);
        set_turn(T.theta_rad, message.transform_().rotation_());
      })));
}

TEST(OdometryMessageTest, IsReadFromRos1) {
  ros::PoseStamped stated;
  stated.header_().frame_id_("room");
  stated.pose_().position_().x_(1.5);
  stated.pose_().position_().y_(-2.0);
  stated.pose_().orientation_().z_(std::sin(0.2));
  stated.pose_().orientation_().w_(std::cos(0.2));
  std::vector<std::byte> bytes;
  encode(stated, Encoding::kRos1, bytes);
  const OdometryMessage read =
      decode_odometry("geometry_msgs/msg/PoseStamped", bytes, Encoding::kRos1);
  EXPECT_EQ(read.header.frame_id_(), "room");
  EXPECT_EQ(read.child_frame, "");
  ASSERT_TRUE(read.T_odom_robot);
  EXPECT_LT(geometry::difference(*read.T_odom_robot, {1.5, -2.0, 0.4}).norm(), 1e-12);
  bytes.resize(bytes.size() - 1);
  EXPECT_THROW(decode_odometry("geometry_msgs/msg/PoseStamped", bytes, Encoding::kRos1),
               DecodeError);
}

}  // namespace
}  // namespace topogeo::recording
