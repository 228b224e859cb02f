#include "topogeo/exchange/carmen.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/scan/carmen_log_writer.hpp"

#include "sample_floor.hpp"
#include "sample_stops.hpp"

namespace topogeo::exchange {
namespace {

class CarmenExport : public ScratchTest {};

TEST_F(CarmenExport, ScansHaveTheBeamsOfTheLaser) {
  const StopScans log = stop_scans(sample_stops());
  ASSERT_EQ(log.scans.size(), 6U);
  EXPECT_LT(log.angle_error_rad, 1e-5);
  EXPECT_EQ(log.lost_points, 0U);
  const scan::Scan& first = log.scans.front();
  EXPECT_EQ(first.ranges_m.size(), 181U);
  EXPECT_EQ(first.angle_min_rad, -std::numbers::pi / 2.0);
  EXPECT_EQ(first.ranges_m[3], scan::Scan::kNoReturn);  // missing in the sample
  EXPECT_NEAR(first.ranges_m[90], 9.0F, 1e-5F);
  EXPECT_NEAR(log.scans[3].ranges_m[90], 6.0F, 1e-5F);
}

TEST_F(CarmenExport, TheLogReadsBackPointByPoint) {
  storage::MapDocument document = sample_stops();
  // A laser that is mounted off the centre and turned.
  const geometry::Pose2 T_robot_laser{0.2, -0.05, 0.3};
  for (topomap::LocalMap& map : document.local_maps) {
    map.T_robot_laser = T_robot_laser;
    for (topomap::ScanPoint& p : map.points) {
      const Eigen::Vector2d moved = T_robot_laser * Eigen::Vector2d(p.x_m, p.y_m);
      p = {static_cast<float>(moved.x()), static_cast<float>(moved.y())};
    }
  }
  const StopScans log = stop_scans(document);
  scan::CarmenLogWriter writer(directory_ / "log.gz", log.T_robot_laser);
  for (const scan::Scan& scan : log.scans) writer.write(scan);
  writer.close();
  scan::CarmenLogReader reader(directory_ / "log.gz");
  for (const topomap::LocalMap& map : document.local_maps) {
    const auto scan = reader.next();
    ASSERT_TRUE(scan);
    EXPECT_EQ(scan->stamp_ns, map.stamp_ns);
    EXPECT_EQ(scan->T_odom_robot, map.T_odom_robot);
    std::size_t next = 0;
    for (std::size_t i = 0; i < scan->ranges_m.size(); ++i) {
      if (scan->ranges_m[i] == scan::Scan::kNoReturn) continue;
      const double angle = scan->angle_min_rad + scan->angle_step_rad * static_cast<double>(i);
      const double range_m = scan->ranges_m[i];
      const Eigen::Vector2d in_robot =
          T_robot_laser * Eigen::Vector2d(range_m * std::cos(angle), range_m * std::sin(angle));
      ASSERT_LT(next, map.points.size());
      EXPECT_NEAR(in_robot.x(), map.points[next].x_m, 2e-4);
      EXPECT_NEAR(in_robot.y(), map.points[next].y_m, 2e-4);
      ++next;
    }
    EXPECT_EQ(next, map.points.size());
  }
  EXPECT_FALSE(reader.next());
}

TEST_F(CarmenExport, ALaterDriveThatWasRecordedBeforeFollowsAMinuteLater) {
  storage::MapDocument document = sample_stops();
  document.local_maps[4].stamp_ns = 100;
  document.local_maps[5].stamp_ns = 1'000'000'100;
  const StopScans log = stop_scans(document);
  EXPECT_EQ(log.scans[4].stamp_ns, 64'000'000'000);
  EXPECT_EQ(log.scans[5].stamp_ns, 65'000'000'000);
}

TEST_F(CarmenExport, AMapWithoutPointsIsRefused) {
  EXPECT_THROW(stop_scans({}), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::exchange
