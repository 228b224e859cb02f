// Beams of recordings: the motion during a sweep, varying numbers of beams, several lasers on one
// topic.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include <gmock/gmock.h>

#include "topogeo/recording/convert.hpp"

#include "recorded_drive.hpp"

namespace topogeo::recording {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class RecordedBeams : public RecordingFiles {
 protected:
  /// An uncompressed bag, so that bytes can be found and changed.
  std::filesystem::path write(const std::vector<scan::Scan>& scans,
                              const geometry::Pose2& T_robot_laser = {}) {
    LogWriter writer(path("a.bag"), T_robot_laser, "none");
    for (const scan::Scan& scan : scans) writer.write(scan);
    writer.close();
    return path("a.bag");
  }
};

std::string bytes_of_floats(const std::vector<float>& values) {
  std::string bytes(values.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

/// angle_min, angle_max and angle_increment, encoded as in a message.
std::string angles_of(const scan::Scan& scan) {
  const auto min_rad = static_cast<float>(scan.angle_min_rad);
  const auto last = static_cast<double>(scan.ranges_m.size() - 1);
  const auto max_rad = static_cast<float>(scan.angle_min_rad + last * scan.angle_step_rad);
  return bytes_of_floats({min_rad, max_rad, static_cast<float>(scan.angle_step_rad)});
}

constexpr int kRays = 360;
constexpr double kRayStep_rad = 2.0 * std::numbers::pi / kRays;
constexpr double kSweep_s = 0.1;
const geometry::Pose2 kOnRobot{0.2, 0.1, 0.5};

/// Range from a pose to the walls of a square room of 8 m around the origin.
double to_wall_m(const geometry::Pose2& pose, double angle_rad) {
  const double x = std::cos(pose.theta_rad + angle_rad);
  const double y = std::sin(pose.theta_rad + angle_rad);
  return std::min((x > 0.0 ? 4.0 - pose.x_m : -4.0 - pose.x_m) / x,
                  (y > 0.0 ? 4.0 - pose.y_m : -4.0 - pose.y_m) / y);
}

/// Pose at this time when driving 0.8 m/s and 1.2 rad/s.
geometry::Pose2 robot_at(double time_s) {
  return {0.8 * time_s - 0.4, 0.0, 1.2 * time_s - 0.6};
}

/// Scans whose rays start at the laser's pose at their own time, or all at that of the stamp.
std::vector<scan::Scan> turning_drive(bool skewed) {
  std::vector<scan::Scan> scans;
  for (int i = 0; i < 10; ++i) {
    scan::Scan scan;
    const double start_s = kSweep_s * i;
    scan.stamp_ns = 1'600'000'000'000'000'000 + i * 100'000'000LL;
    scan.angle_min_rad = -std::numbers::pi;
    scan.angle_step_rad = kRayStep_rad;
    scan.T_odom_robot = robot_at(start_s);
    for (int ray = 0; ray < kRays; ++ray) {
      const double time_s = start_s + (skewed ? kSweep_s / kRays * ray : 0.0);
      scan.ranges_m.push_back(static_cast<float>(
          to_wall_m(robot_at(time_s) * kOnRobot, -std::numbers::pi + kRayStep_rad * ray)));
    }
    scans.push_back(std::move(scan));
  }
  return scans;
}

double largest_error_m(const scan::Scan& scan, const scan::Scan& truth) {
  double error_m = 0.0;
  for (std::size_t i = 0; i < truth.ranges_m.size(); ++i) {
    if (scan.ranges_m[i] == scan::Scan::kNoReturn) continue;
    error_m = std::max(error_m, std::fabs(static_cast<double>(scan.ranges_m[i]) -
                                          static_cast<double>(truth.ranges_m[i])));
  }
  return error_m;
}

TEST_F(RecordedBeams, AreThoseOfOneMoment) {
  const std::vector<scan::Scan> skewed = turning_drive(true);
  const std::vector<scan::Scan> truth = turning_drive(false);
  const auto file = write(skewed, kOnRobot);
  std::string bytes = bytes_of(file);
  const std::string angles = angles_of(skewed.front());
  const std::string step_s = bytes_of_floats({static_cast<float>(kSweep_s / kRays)});
  int found = 0;
  for (std::size_t at = bytes.find(angles); at != std::string::npos;
       at = bytes.find(angles, at + 1), ++found) {
    bytes.replace(at + angles.size(), step_s.size(), step_s);
  }
  ASSERT_EQ(found, 10);
  put_bytes(file, bytes);

  EXPECT_EQ(read_scans(file).front().ranges_m, skewed.front().ranges_m);  // only on request
  TopicChoice forward;
  forward.sweep = ros::SweepOrder::kForward;
  const std::vector<scan::Scan> scans = read_scans(file, forward);
  ASSERT_EQ(scans.size(), truth.size());
  for (std::size_t i = 0; i + 1 < scans.size(); ++i) {
    EXPECT_GT(largest_error_m(skewed[i], truth[i]), 0.2);
    EXPECT_LT(largest_error_m(scans[i], truth[i]), 0.06);
    EXPECT_LT(std::ranges::count(scans[i].ranges_m, scan::Scan::kNoReturn), 12);
  }
  // Without odometry the times are kept for whoever makes odometry from the scans.
  TopicChoice without = forward;
  without.odometry_use = OdometryUse::kIgnored;
  for (const scan::Scan& scan : read_scans(file, without)) {
    EXPECT_EQ(scan.first_beam_s, 0.0);
    EXPECT_NEAR(scan.beam_step_s, kSweep_s / kRays, 1e-6);
  }
  EXPECT_EQ(read_scans(file, without).front().ranges_m, skewed.front().ranges_m);
  // No odometry covers the end of the last sweep.
  EXPECT_EQ(scans.back().ranges_m, skewed.back().ranges_m);
  ConvertOptions options;
  options.topics = forward;
  (void)convert(file, path("b.mcap"), options);
  expect_same_scans(read_scans(path("b.mcap"), forward), scans);
  (void)convert(file, path("b.clf"), options);
  expect_same_scans(read_scans(path("b.clf")), scans);
}

TEST_F(RecordedBeams, ThatLackAreNoEchoes) {
  std::vector<scan::Scan> drive = short_drive();
  drive[0].ranges_m.resize(5);  // 5 instead of 7, also in the first scan
  drive[4].ranges_m.erase(drive[4].ranges_m.begin());
  drive[4].angle_min_rad += drive[4].angle_step_rad;
  const auto file = write(drive);
  const std::vector<scan::Scan> scans = read_scans(file);
  ASSERT_EQ(scans.size(), drive.size());
  for (const scan::Scan& scan : scans) {
    EXPECT_EQ(scan.angle_min_rad, -0.75);
    EXPECT_EQ(scan.ranges_m.size(), 7U);
  }
  EXPECT_THAT(scans[0].ranges_m, ElementsAre(1.0F, 1.1F, 1.2F, 1.3F, 1.4F, 0.0F, 0.0F));
  EXPECT_EQ(scans[4].ranges_m[0], scan::Scan::kNoReturn);
  EXPECT_EQ(scans[4].ranges_m[1], drive[4].ranges_m[0]);
  EXPECT_EQ(scans[5].ranges_m, drive[5].ranges_m);
  EXPECT_THAT(mounting_in_log(file).notes,
              testing::Contains(HasSubstr("2 scans have other beams than 7 beams")));
  EXPECT_GT(check_log(file).faults(), 0U);  // reported unchanged
}

TEST_F(RecordedBeams, OfAnotherLaserAreLeftOut) {
  std::vector<scan::Scan> drive = short_drive();
  drive[3].angle_min_rad = 2.0;
  const auto file = write(drive);
  EXPECT_EQ(read_scans(file).size(), drive.size() - 1);
  EXPECT_THAT(mounting_in_log(file).notes, testing::Contains(HasSubstr("left out")));
  LogReader reader(file);
  while (reader.next()) {
  }
  EXPECT_EQ(reader.statistics().skipped_total(), 1U);
  EXPECT_THAT(reader.statistics().messages.front(),
              HasSubstr("scan 4: expected 7 beams from -0.7500 rad by 0.25000 rad as in most "
                        "scans, got 7 beams from 2.0000 rad"));
}

TEST_F(RecordedBeams, OfAnotherFrameAreLeftOut) {
  const auto file = write(short_drive());
  std::string bytes = bytes_of(file);
  const std::size_t last = bytes.rfind("laser" + angles_of(short_drive().front()));
  ASSERT_NE(last, std::string::npos);
  put_bytes(file, bytes.replace(last, 5, "front"));
  LogReader reader(file);
  while (reader.next()) {
  }
  EXPECT_EQ(reader.statistics().skipped_total(), 1U);
  EXPECT_THAT(reader.statistics().messages.front(),
              HasSubstr("scan 20: frame_id: expected laser, got front"));
}

}  // namespace
}  // namespace topogeo::recording
