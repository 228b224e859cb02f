#include "topogeo/matching/match_features.hpp"

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "localization/hand_scenes.hpp"
#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using test::kDegree;

TEST(MatchFeaturesTest, PointsAreThinnedToTheirSpacing) {
  const auto points = test::exact_points(test::l_room(), {});
  const MatchFeatures features = extract_scan_features(points, {});
  ASSERT_GT(features.surface.size(), 100U);
  ASSERT_GT(features.coarse.size(), 50U);
  for (std::size_t i = 1; i < features.surface.size(); ++i) {
    EXPECT_GE((features.surface[i].position_m - features.surface[i - 1].position_m).norm(),
              MatchFeatures::kFineSpacing_m - 1e-9);
  }
  for (std::size_t i = 1; i < features.coarse.size(); ++i) {
    EXPECT_GE((features.coarse[i].position_m - features.coarse[i - 1].position_m).norm(),
              MatchFeatures::kCoarseSpacing_m - 1e-9);
  }
  // Every dropped point is within the spacing of a kept one.
  for (const auto& p : points) {
    double nearest_m = 1e9;
    for (const SurfacePoint& kept : features.coarse) {
      nearest_m = std::min(nearest_m, (kept.position_m - Eigen::Vector2d(p.x_m, p.y_m)).norm());
    }
    EXPECT_LT(nearest_m, MatchFeatures::kCoarseSpacing_m);
  }
}

TEST(MatchFeaturesTest, NormalsStandOnTheWalls) {
  // The L-shaped room again: away from its corners every wall is along x or along y.
  const MatchFeatures features = test::features_at(test::l_room(), {});
  const std::vector<Eigen::Vector2d> corners{{-2, -2}, {2, -2}, {2, 0}, {4, 0}, {4, 3}, {-2, 3}};
  int checked = 0;
  for (const SurfacePoint& point : features.surface) {
    double corner_m = 1e9;
    for (const auto& corner : corners) {
      corner_m = std::min(corner_m, (corner - point.position_m).norm());
    }
    if (corner_m < 0.8) continue;
    const Eigen::Vector2d& p = point.position_m;
    const bool along_x = std::min({std::fabs(p.y() + 2), std::fabs(p.y() - 3),
                                   p.x() > 2 ? std::fabs(p.y()) : 9.0}) < 0.01;
    EXPECT_TRUE(point.on_line) << p.transpose();
    EXPECT_NEAR(point.normal.norm(), 1.0, 1e-9);
    EXPECT_GT(std::fabs(along_x ? point.normal.y() : point.normal.x()), 0.999) << p.transpose();
    EXPECT_LT(point.normal.dot(p), 0.0) << "on the side of the laser: " << p.transpose();
    ++checked;
  }
  EXPECT_GT(checked, 50);
}

TEST(MatchFeaturesTest, NormalsOfASlantingWall) {
  const world::World wall = test::lines({{{2, -4}, {6, 4}}});
  const MatchFeatures features = test::features_at(wall, {});
  ASSERT_GT(features.surface.size(), 20U);
  const Eigen::Vector2d along = Eigen::Vector2d(4, 8).normalized();
  for (const SurfacePoint& point : features.surface) {
    EXPECT_TRUE(point.on_line);
    EXPECT_NEAR(point.normal.dot(along), 0.0, 1e-3);
  }
}

// One side of a corridor with beams one degree apart: gaps grow with the range.
TEST(MatchFeaturesTest, AWallThatACoarseLaserSeesAtAFlatAngleIsALine) {
  std::vector<topomap::ScanPoint> points;
  for (int degree = 90; degree >= 7; --degree) {
    points.push_back({static_cast<float>(1.0 / std::tan(degree * kDegree)), 1.0F});
  }
  const MatchFeatures features = extract_scan_features(points, {});
  double farthest_m = 0.0;
  for (const SurfacePoint& point : features.surface) {
    if (!point.on_line) continue;
    EXPECT_NEAR(point.normal.y(), -1.0, 1e-6);
    farthest_m = std::max(farthest_m, point.position_m.x());
  }
  EXPECT_GT(farthest_m, 7.0);
}

TEST(MatchFeaturesTest, LonelyPointsAreOnNoLine) {
  const std::vector<topomap::ScanPoint> points{{2, -2}, {2, 0}, {2, 0.05F}, {2, 2}};
  const MatchFeatures features = extract_scan_features(points, {});
  ASSERT_EQ(features.surface.size(), 4U);
  for (const SurfacePoint& point : features.surface) EXPECT_FALSE(point.on_line);
}

TEST(MatchFeaturesTest, NothingComesOfNothing) {
  const MatchFeatures features = extract_scan_features({}, {});
  EXPECT_TRUE(features.surface.empty());
  EXPECT_TRUE(features.coarse.empty());
  EXPECT_EQ(features.profile.view({1.0, 0.0}, 0.3), RangeProfile::View::kUnknown);
}

topomap::LocalBranch straight_branch(double step_m, std::size_t count, double clearance_m) {
  topomap::LocalBranch branch;
  for (std::size_t i = 0; i < count; ++i) {
    branch.points.push_back({{step_m * static_cast<double>(i), 1.0}, clearance_m});
  }
  return branch;
}

TEST(BranchSamplesTest, LieEverySpacingWithDirectionAndClearance) {
  topomap::LocalMap map;
  map.branches.push_back(straight_branch(0.0625, 30, 0.8));
  const MatchFeatures features = extract_features(map);
  // The first step, then every fourth: 0.25 m is the first multiple of the step over 0.20 m.
  ASSERT_EQ(features.branches.size(), 8U);
  for (std::size_t i = 0; i < features.branches.size(); ++i) {
    EXPECT_DOUBLE_EQ(features.branches[i].position_m.x(), 0.0625 + 0.25 * static_cast<double>(i));
    EXPECT_NEAR(std::fabs(features.branches[i].direction.x()), 1.0, 1e-12);
    EXPECT_DOUBLE_EQ(features.branches[i].clearance_m, 0.8);
  }
}

TEST(BranchSamplesTest, VirtualBranchesAndImaginaryNodesAreLeftOut) {
  topomap::LocalMap map;
  map.branches.push_back(straight_branch(0.1, 30, 0.8));
  map.branches.back().is_virtual = true;
  using topomap::NodeKind;
  for (const NodeKind kind : {NodeKind::kReal, NodeKind::kFictitious, NodeKind::kVirtual,
                              NodeKind::kDoor, NodeKind::kNarrowing, NodeKind::kHallCorridor}) {
    map.nodes.push_back(test::node(1.0, 2.0, 0.5, kind));
  }
  const MatchFeatures features = extract_features(map);
  EXPECT_TRUE(features.branches.empty());
  ASSERT_EQ(features.nodes.size(), 4U);
  for (const topomap::LocalNode& node : features.nodes) {
    EXPECT_NE(node.kind, NodeKind::kFictitious);
    EXPECT_NE(node.kind, NodeKind::kVirtual);
  }
}

TEST(MatchFeaturesTest, CurvesRunFromEndToEnd) {
  topomap::LocalMap map;
  topomap::LocalBranch branch;
  for (int i = 0; i <= 21; ++i) branch.points.push_back({{0.05 * i, 1.0}, 0.5 + 0.1 * i});
  map.branches.push_back(branch);
  branch.is_virtual = true;
  map.branches.push_back(branch);
  branch.is_virtual = false;
  branch.confirmed = false;
  map.branches.push_back(branch);
  const MatchFeatures features = extract_features(map);
  ASSERT_EQ(features.curves.size(), 1U) << "neither virtual nor unconfirmed ones";
  const BranchCurve& curve = features.curves.front();
  EXPECT_EQ(curve.points_m.front(), Eigen::Vector2d(0.0, 1.0));
  EXPECT_EQ(curve.points_m.back(), Eigen::Vector2d(0.05 * 21, 1.0));
  EXPECT_NEAR(curve.clearance_m, 0.5 + 0.1 * 10.5, 1e-12);
  for (std::size_t i = 1; i < curve.points_m.size(); ++i) {
    const double step_m = (curve.points_m[i] - curve.points_m[i - 1]).norm();
    EXPECT_GT(step_m, 0.09);
    EXPECT_LT(step_m, 0.21);
  }
}

// Places without a neighbour refer to the last element: nothing may be near it.
TEST(MatchFeaturesTest, TheArraysOfAReferenceAreItsFeaturesAndOneFarAway) {
  MatchFeatures features = test::features_at(test::l_room(), {});
  features.branches = {test::sample(1.0, 2.0, 0.5, 0.7)};
  const Reference reference = make_reference(features);
  ASSERT_EQ(reference.surfaces.size(), features.surface.size() + 1);
  for (std::size_t i = 0; i < features.surface.size(); ++i) {
    const Eigen::Vector2f at_m = features.surface[i].position_m.cast<float>();
    const Eigen::Vector2f normal = features.surface[i].normal.cast<float>();
    EXPECT_EQ(reference.surfaces[i].x_m, at_m.x());
    EXPECT_EQ(reference.surfaces[i].y_m, at_m.y());
    EXPECT_EQ(reference.surfaces[i].normal_x, normal.x());
    EXPECT_EQ(reference.surfaces[i].normal_y, normal.y());
  }
  EXPECT_GT(reference.surfaces.back().x_m, 1e8F);
  ASSERT_EQ(reference.branches.size(), 2U);
  EXPECT_EQ(reference.branches[0].x_m, 1.0F);
  EXPECT_EQ(reference.branches[0].y_m, 2.0F);
  EXPECT_EQ(reference.branches[0].direction_x, static_cast<float>(std::cos(0.5)));
  EXPECT_EQ(reference.branches[0].direction_y, static_cast<float>(std::sin(0.5)));
  EXPECT_EQ(reference.branches[0].clearance_m, 0.7F);
  EXPECT_GT(reference.branches[1].x_m, 1e8F);
  EXPECT_EQ(make_reference({}).surfaces.size(), 1U);
}

TEST(MatchFeaturesTest, AReferenceMadeInTheMemoryOfAnotherIsLikeANewOne) {
  MatchFeatures large = test::features_at(test::world("floor"), {6.0, 1.0, 0.0});
  large.branches = {test::sample(1.0, 2.0, 0.5, 0.7), test::sample(2.0, 2.0, 0.5, 0.7)};
  const MatchFeatures small = test::features_at(test::l_room(), {});
  Reference reference;
  for (const MatchFeatures& features : {large, small, MatchFeatures(), large}) {
    const Reference fresh = make_reference(features);
    remake_reference(std::make_shared<const MatchFeatures>(features), reference);
    ASSERT_EQ(reference.features->surface.size(), features.surface.size());
    ASSERT_EQ(reference.surfaces.size(), fresh.surfaces.size());
    ASSERT_EQ(reference.branches.size(), fresh.branches.size());
    for (std::size_t i = 0; i < fresh.surfaces.size(); ++i) {
      EXPECT_EQ(reference.surfaces[i].x_m, fresh.surfaces[i].x_m);
    }
    for (std::size_t i = 0; i < fresh.branches.size(); ++i) {
      EXPECT_EQ(reference.branches[i].x_m, fresh.branches[i].x_m);
    }
    for (double x = -12.0; x < 12.0; x += 0.07) {
      for (double y = -12.0; y < 12.0; y += 0.07) {
        ASSERT_EQ(reference.surface_grid.find(x, y), fresh.surface_grid.find(x, y));
        ASSERT_EQ(reference.branch_grid.find(x, y), fresh.branch_grid.find(x, y));
      }
    }
  }
}

}  // namespace
}  // namespace topogeo::localization
