// Our encoding of messages against that of fastddsgen and Fast CDR, and by hand for ROS 1.
#include <gtest/gtest.h>

#include "topogeo/recording/ros_codec.hpp"
#include "topogeo/recording/ros_definitions.hpp"
#include "topogeo/ros_conversions/messages.hpp"

#include "fast_cdr.hpp"

namespace topogeo::recording {
namespace {

template <typename Message>
std::vector<std::byte> encoded(const Message& message, Encoding encoding) {
  std::vector<std::byte> bytes;
  encode(message, encoding, bytes);
  return bytes;
}

ros::LaserScan some_scan() {
  ros::LaserScan scan;
  scan.header_().stamp_().sec_(7);
  scan.header_().stamp_().nanosec_(8);
  scan.header_().frame_id_("laser");
  scan.angle_min_(-1.5F);
  scan.angle_increment_(0.5F);
  scan.range_max_(12.0F);
  scan.ranges_({1.0F, 2.0F, 3.0F});
  scan.intensities_({4.0F});
  return scan;
}

ros::TFMessage some_transforms() {
  ros::TFMessage message;
  for (const char* child : {"base_link", "laser_of_the_front"}) {
    ros::TransformStamped& stated = message.transforms_().emplace_back();
    stated.header_().frame_id_("odom");
    stated.child_frame_id_(child);
    stated.transform_().translation_().x_(1.25);
    stated.transform_().rotation_().w_(1.0);
  }
  return message;
}

ros::MarkerArray some_markers() {
  ros::MarkerArray array;
  for (int i = 0; i < 2; ++i) {
    ros::Marker& marker = array.markers_().emplace_back();
    marker.ns_("branch");
    marker.id_(i);
    marker.frame_locked_(true);
    marker.points_().resize(static_cast<std::size_t>(3 - i));
    marker.colors_().resize(1);
    marker.text_("room A");
    marker.texture_().data_({1, 2, 3});
  }
  return array;
}

template <typename Message>
void expect_like_fast_cdr(const Message& message) {
  using eprosima::fastcdr::Cdr;
  EXPECT_EQ(encoded(message, Encoding::kCdr), by_fast_cdr(message, Cdr::LITTLE_ENDIANNESS));
  for (const auto order : {Cdr::LITTLE_ENDIANNESS, Cdr::BIG_ENDIANNESS}) {
    EXPECT_TRUE(decode<Message>(by_fast_cdr(message, order), Encoding::kCdr) == message);
  }
}

TEST(RosCodec, WritesAndReadsWhatFastCdrDoes) {
  expect_like_fast_cdr(some_scan());
  expect_like_fast_cdr(some_transforms());
  expect_like_fast_cdr(some_markers());
  ros::Odometry odometry;
  odometry.header_().frame_id_("odom");
  odometry.child_frame_id_("base_footprint");
  odometry.pose_().covariance_()[35] = 2.0;
  expect_like_fast_cdr(odometry);
  EXPECT_EQ(encoded(odometry, Encoding::kCdr).size(), 724U);
  ros::OccupancyGrid grid;
  grid.info_().width_(3);
  grid.data_({0, 100, -1});
  expect_like_fast_cdr(grid);
  expect_like_fast_cdr(ros::PoseWithCovarianceStamped());
}

TEST(RosCodec, WritesHeadersOfRos1WithASequenceNumberAndNoAlignment) {
  ros::TFMessage message;
  const std::vector<std::byte> none = encoded(message, Encoding::kRos1);
  EXPECT_EQ(none, std::vector<std::byte>(4));
  const std::vector<std::byte> scan = encoded(some_scan(), Encoding::kRos1);
  // seq, stamp, length and text of the frame, seven numbers, two lengths, four numbers
  EXPECT_EQ(scan.size(), 4U + 8 + 4 + 5 + 7 * 4 + 4 + 3 * 4 + 4 + 4);
  EXPECT_EQ(scan[4], std::byte{7});
  EXPECT_EQ(scan[16], static_cast<std::byte>('l'));
  EXPECT_TRUE(decode<ros::LaserScan>(scan, Encoding::kRos1) == some_scan());
  EXPECT_TRUE(decode<ros::TFMessage>(encoded(some_transforms(), Encoding::kRos1),
                                     Encoding::kRos1) == some_transforms());
}

TEST(RosCodec, RefusesWhatEndsEarlyWithItsPosition) {
  for (const Encoding encoding : {Encoding::kCdr, Encoding::kRos1}) {
    const std::vector<std::byte> whole = encoded(some_scan(), encoding);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      EXPECT_THROW((void)decode<ros::LaserScan>(std::span(whole).first(size), encoding),
                   DecodeError)
          << size;
    }
  }
  std::vector<std::byte> huge = encoded(ros::TFMessage(), Encoding::kCdr);
  for (std::size_t i = 4; i < 8; ++i) huge[i] = std::byte{0xFF};
  EXPECT_THROW((void)decode<ros::TFMessage>(huge, Encoding::kCdr), DecodeError);
  huge[1] = std::byte{7};
  try {
    (void)decode<ros::TFMessage>(huge, Encoding::kCdr);
    FAIL();
  } catch (const DecodeError& error) {
    EXPECT_STREQ(error.what(), "byte 0: expected plain CDR, got representation 7");
  }
}

TEST(RosDefinitions, NameEachPartOnce) {
  const std::string text = ros2_definition_text("tf2_msgs/msg/TFMessage");
  const std::string rule(80, '=');
  EXPECT_EQ(text.find("geometry_msgs/TransformStamped[] transforms\n" + rule +
                      "\nMSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\n"),
            0U);
  for (const char* part : {"std_msgs/Header", "geometry_msgs/Vector3", "geometry_msgs/Quaternion",
                           "builtin_interfaces/Time", "geometry_msgs/Transform"}) {
    const std::string line = std::string("MSG: ") + part + "\n";
    EXPECT_NE(text.find(line), std::string::npos) << part;
    EXPECT_EQ(text.find(line), text.rfind(line)) << part;
  }
  const std::string ros1 = ros1_definition_text("sensor_msgs/msg/LaserScan");
  EXPECT_EQ(ros1.find("Header header\nfloat32 angle_min\n"), 0U);
  EXPECT_NE(ros1.find("MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"),
            std::string::npos);
}

}  // namespace
}  // namespace topogeo::recording
