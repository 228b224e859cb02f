#include "topogeo/slam/stored_map.hpp"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

StoredMap three_stops() {
  StoredMap map;
  map.maps.resize(3);
  map.trajectory.stops.resize(3);
  for (std::uint32_t i = 0; i < 3; ++i) {
    map.maps[i].id = i;
    map.trajectory.stops[i].T_map_robot = {1.0 * i, 0.5, 0.1 * i};
  }
  return map;
}

TEST(StoredMap, HoldsNeighboursAndLoopsTogether) {
  StoredMap map = three_stops();
  map.loop_closures = {{0, 2, {2.05, 0.0, 0.2}}};
  const std::vector<PoseGraphEdge> edges = edges_of(map);
  ASSERT_EQ(edges.size(), 3U);
  for (std::uint32_t i = 0; i < 2; ++i) {
    EXPECT_EQ(edges[i].from, i);
    EXPECT_EQ(edges[i].to, i + 1);
    EXPECT_EQ(edges[i].kind, EdgeKind::kSequential);
    EXPECT_EQ(edges[i].T_from_to, geometry::between(map.trajectory.stops[i].T_map_robot,
                                                    map.trajectory.stops[i + 1].T_map_robot));
  }
  EXPECT_EQ(edges[2].kind, EdgeKind::kRevisit);
  EXPECT_EQ(edges[2].T_from_to, (geometry::Pose2{2.05, 0.0, 0.2}));
  EXPECT_EQ(edges[2].covariance, edges[0].covariance);
}

TEST(StoredMap, DrivesHangTogetherByTheirLoops) {
  StoredMap map = three_stops();
  map.maps[2].starts_drive = true;
  const std::vector<PoseGraphEdge> edges = edges_of(map);
  EXPECT_TRUE(edges[1].covariance.isApprox(100.0 * edges[0].covariance));
}

TEST(StoredMap, TakesTheMeasurementsThatItKeepsAndFillsWhatTheyLack) {
  StoredMap map = three_stops();
  map.loop_closures = {{0, 2, {2.05, 0.0, 0.2}}};
  const Eigen::Matrix3d covariance = 0.01 * Eigen::Matrix3d::Identity();
  map.edges = {{0, 1, EdgeKind::kOdometry, {1.1, 0.0, 0.1}, covariance}};
  const std::vector<PoseGraphEdge> edges = edges_of(map);
  ASSERT_EQ(edges.size(), 2U) << "its loops are among them, if they are known";
  EXPECT_EQ(edges[0].T_from_to, (geometry::Pose2{1.1, 0.0, 0.1}));
  EXPECT_EQ(edges[0].covariance, covariance);
  EXPECT_EQ(edges[1].from, 1U) << "nothing else leads to stop 2";
  EXPECT_EQ(edges[1].to, 2U);
  map.edges[0].to = 3;
  EXPECT_THROW(check(map), std::invalid_argument);
}

TEST(StoredMap, HasAStopForEachLocalMap) {
  EXPECT_NO_THROW(check(three_stops()));
  StoredMap fewer = three_stops();
  fewer.trajectory.stops.pop_back();
  EXPECT_THROW(check(fewer), std::invalid_argument);
  EXPECT_THROW(check(StoredMap{}), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::localization
