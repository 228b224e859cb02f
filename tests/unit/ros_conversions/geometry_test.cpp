#include "topogeo/ros_conversions/geometry.hpp"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace topogeo::ros {
namespace {

TEST(Stamps, ComeBack) {
  for (const std::int64_t stamp_ns : {0LL, 1'500'000'001LL, 4'000'000'000'000'000'007LL}) {
    EXPECT_EQ(stamp_ns_of(time_of(stamp_ns)), stamp_ns);
  }
  EXPECT_EQ(time_of(1'500'000'001).sec_(), 1);
  EXPECT_EQ(time_of(1'500'000'001).nanosec_(), 500'000'001U);
  EXPECT_THROW((void)time_of(-1), std::invalid_argument);
  EXPECT_THROW((void)time_of(std::numeric_limits<std::int64_t>::max()), std::invalid_argument);
}

TEST(Stamps, OfPeersLeaveRoomForWhatFollowsThem) {
  EXPECT_EQ(usable_stamp_ns(1'500'000'001), 1'500'000'001);
  Time last;
  last.sec_(-1);
  last.nanosec_(std::numeric_limits<std::uint32_t>::max());
  for (const std::int64_t stamp_ns :
       {stamp_ns_of(last), std::int64_t{-1}, std::numeric_limits<std::int64_t>::max(),
        std::numeric_limits<std::int64_t>::min()}) {
    EXPECT_NO_THROW((void)time_of(usable_stamp_ns(stamp_ns))) << stamp_ns;
    EXPECT_NO_THROW((void)time_of(usable_stamp_ns(stamp_ns) + 10'000'000'000)) << stamp_ns;
  }
}

TEST(FrameNames, LoseTheSlashOfRos1) {
  EXPECT_EQ(frame_name("/base_link"), "base_link");
  EXPECT_EQ(frame_name("base_link"), "base_link");
  EXPECT_EQ(frame_name(""), "");
}

TEST(PlanarPose, IsSeenFromAbove) {
  Pose pose;
  pose.position_().x_(1.0);
  EXPECT_FALSE(planar(pose));  // a quaternion of zero length
  const Eigen::Quaterniond q = Eigen::AngleAxisd(2.5, Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitY());
  pose.orientation_().x_(3.0 * q.x());
  pose.orientation_().y_(3.0 * q.y());
  pose.orientation_().z_(3.0 * q.z());
  pose.orientation_().w_(3.0 * q.w());
  ASSERT_TRUE(planar(pose));
  EXPECT_NEAR(planar(pose)->theta_rad, 2.5, 1e-12);
  for (const double far_m : {std::numeric_limits<double>::infinity(), -1e308, 1.01 * kFarthest_m}) {
    pose.position_().y_(far_m);
    EXPECT_FALSE(planar(pose)) << far_m;
  }
}

TEST(PlanarPose, ComesBack) {
  const geometry::Pose2 pose{1.0, -2.0, 3.0};
  const auto again = planar(transform_of("a", "b", pose, 0).transform_());
  ASSERT_TRUE(again);
  EXPECT_EQ(again->x_m, pose.x_m);
  EXPECT_EQ(again->y_m, pose.y_m);
  EXPECT_NEAR(again->theta_rad, pose.theta_rad, 1e-12);
}

TEST(Covariance, ComesBackAndIsInvertible) {
  Eigen::Matrix3d covariance;
  covariance << 1.0, 0.1, 0.2, 0.1, 2.0, 0.3, 0.2, 0.3, 3.0;
  const PoseWithCovarianceStamped pose = pose_of("map", 0, {}, covariance);
  const auto& rows = pose.pose_().covariance_();
  EXPECT_EQ(rows[0], 1.0);
  EXPECT_EQ(rows[5], 0.2);
  EXPECT_EQ(rows[11], 0.3);
  EXPECT_EQ(rows[35], 3.0);
  for (const std::size_t flat : {14U, 21U, 28U}) EXPECT_GT(rows[flat], 0.0);
  EXPECT_EQ(planar_covariance(rows), covariance);
}

}  // namespace
}  // namespace topogeo::ros
