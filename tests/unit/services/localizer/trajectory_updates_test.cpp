#include "localizer/trajectory_updates.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::localizer {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

topomap::Trajectory trajectory(std::size_t stops) {
  topomap::Trajectory result;
  for (std::size_t i = 0; i < stops; ++i) {
    topomap::StopPose stop;
    stop.local_map_id = static_cast<std::uint32_t>(i);
    stop.T_map_robot.x_m = static_cast<double>(i);
    result.stops.push_back(stop);
  }
  return result;
}

TEST(TrajectoryUpdates, AnEmptyTrajectoryHasNothingToSend) {
  EXPECT_THAT(TrajectoryUpdates().update({}), IsEmpty());
}

TEST(TrajectoryUpdates, FirstEverythingThenOnlyWhatChanged) {
  TrajectoryUpdates updates;
  topomap::Trajectory now = trajectory(600);
  EXPECT_THAT(updates.update(now), ElementsAre(0U, 1U, 2U));
  EXPECT_THAT(updates.update(now), IsEmpty());
  now = trajectory(601);
  EXPECT_THAT(updates.update(now), ElementsAre(2U)) << "a new stop";
  now.stops[255].T_map_robot.theta_rad = 1e-12;
  now.stops[512].covariance(2, 2) = 1.0;
  EXPECT_THAT(updates.update(now), ElementsAre(0U, 2U));
}

TEST(TrajectoryUpdates, AFullSegmentIsFollowedByANewOne) {
  TrajectoryUpdates updates;
  EXPECT_THAT(updates.update(trajectory(256)), ElementsAre(0U));
  EXPECT_THAT(updates.update(trajectory(257)), ElementsAre(1U));
}

}  // namespace
}  // namespace topogeo::localizer
