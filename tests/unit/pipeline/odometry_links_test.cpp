#include "topogeo/pipeline/odometry_links.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace topogeo::pipeline {
namespace {

using Kind = storage::MapEdge::Kind;

/// Stops a metre apart on a line, each with its edge of odometry.
storage::MapDocument line(std::uint32_t stops) {
  storage::MapDocument document;
  document.local_maps.resize(stops);
  document.trajectory.stops.resize(stops);
  const Eigen::Matrix3d covariance = Eigen::Vector3d(0.01, 0.01, 0.0004).asDiagonal();
  for (std::uint32_t id = 1; id < stops; ++id) {
    document.edges.push_back({id - 1, id, {1.0, 0.0, 0.0}, covariance, Kind::kOdometry});
  }
  return document;
}

void match(storage::MapDocument& document, std::uint32_t earlier, std::uint32_t later, Kind kind) {
  document.edges.push_back({earlier, later, {}, Eigen::Matrix3d::Identity(), kind});
}

TEST(OdometryStretches, AStepBetweenMatchesRestsOnOdometry) {
  // Stops 0-1-2 | 3 | 4-5: nothing measures the steps to 3 and 4.
  storage::MapDocument document = line(6);
  match(document, 0, 2, Kind::kSequential);
  match(document, 4, 5, Kind::kSequential);
  const auto stretches = odometry_stretches(document);
  ASSERT_EQ(stretches.size(), 1U);
  EXPECT_EQ(stretches[0].first_id, 2U);
  EXPECT_EQ(stretches[0].last_id, 4U);
  EXPECT_EQ(stretches[0].steps(), 2U);
  EXPECT_DOUBLE_EQ(stretches[0].length_m, 2.0);
  EXPECT_FALSE(stretches[0].held_by_loop);
  // Two steps of 0.01 m^2 in each direction; the heading of the first moves the second's end.
  EXPECT_NEAR(stretches[0].off_m, 2.0 * std::sqrt(0.04 + 0.0004), 0.01);
  EXPECT_NEAR(stretches[0].off_rad, 2.0 * std::sqrt(0.0008), 0.01);
}

TEST(OdometryStretches, AMatchAcrossTheStepMeasuresIt) {
  storage::MapDocument document = line(4);
  match(document, 0, 3, Kind::kSequential);
  EXPECT_TRUE(odometry_stretches(document).empty());
}

TEST(OdometryStretches, ALoopHoldsTheStepsWithin) {
  storage::MapDocument document = line(5);
  match(document, 0, 3, Kind::kLoop);
  const auto stretches = odometry_stretches(document);
  ASSERT_EQ(stretches.size(), 2U);
  EXPECT_TRUE(stretches[0].held_by_loop);
  EXPECT_EQ(stretches[0].last_id, 3U);
  EXPECT_FALSE(stretches[1].held_by_loop);
  EXPECT_EQ(stretches[1].first_id, 3U);
}

TEST(OdometryStretches, NothingWithoutEdgesOrAcrossDrives) {
  storage::MapDocument document = line(4);
  std::erase_if(document.edges, [](const auto& edge) { return edge.later_id == 2; });
  match(document, 0, 1, Kind::kSequential);
  match(document, 2, 3, Kind::kSequential);
  EXPECT_TRUE(odometry_stretches(document).empty());
  document.edges = {{7, 9, {}, Eigen::Matrix3d::Identity(), Kind::kOdometry}};
  EXPECT_TRUE(odometry_stretches(document).empty());
}

}  // namespace
}  // namespace topogeo::pipeline
