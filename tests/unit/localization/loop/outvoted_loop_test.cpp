// Two stops 1 m apart by the optimised poses.
#include "loop/outvoted_loop.hpp"

#include <array>

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

using geometry::Pose2;

/// An edge between the two stops that measures `x_m`, with a deviation of 0.1 m.
PoseGraphEdge measured(EdgeKind kind, double x_m) {
  PoseGraphEdge edge{0, 1, kind, {x_m, 0.0, 0.0}};
  edge.covariance = Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal();
  return edge;
}

TEST(OutvotedLoop, IsFiveAndAHalfDeviationsFromTheOptimisedPoses) {
  const std::array<Pose2, 2> poses{Pose2{}, Pose2{1.0, 0.0, 0.0}};
  EXPECT_FALSE(is_outvoted(measured(EdgeKind::kRevisit, 1.54), poses));
  EXPECT_TRUE(is_outvoted(measured(EdgeKind::kRevisit, 1.56), poses));
}

TEST(OutvotedLoop, IsNeverAStep) {
  const std::array<Pose2, 2> poses{Pose2{}, Pose2{1.0, 0.0, 0.0}};
  EXPECT_FALSE(is_outvoted(measured(EdgeKind::kOdometry, 9.0), poses));
  EXPECT_FALSE(is_outvoted(measured(EdgeKind::kSequential, 9.0), poses));
}

}  // namespace
}  // namespace topogeo::localization
