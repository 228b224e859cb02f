#include <gtest/gtest.h>

#include "topogeo/slam/match_requests.hpp"
#include "topogeo/slam/pose_graph.hpp"

namespace topogeo::localization {
namespace {

UncertainPose predicted(double sigma_m, double sigma_rad) {
  return {
      {1.0, 2.0, 0.5},
      Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal()};
}

// 95 % of a circular error lies within 2.4477 deviations; the heading is searched to 3 deviations.
TEST(SearchSpace, IsTheRectangleOfTheErrorEllipse) {
  const MatchTask task = match_task({}, predicted(0.5, 0.1));
  EXPECT_NEAR(task.half_width.x(), 0.5 * 2.4477, 1e-3);
  EXPECT_NEAR(task.half_width.y(), 0.5 * 2.4477, 1e-3);
  EXPECT_NEAR(task.half_width.z(), 0.3, 1e-12);
  EXPECT_EQ(task.T_reference_query, (geometry::Pose2{1.0, 2.0, 0.5}));
}

TEST(SearchSpace, IsNeitherFinerThanTheResolutionNorWiderThanTheLargest) {
  LocalizerConfig config;
  const MatchTask fine = match_task(config, predicted(1e-4, 1e-4));
  EXPECT_EQ(fine.half_width.x(), config.genetic.resolution_m);
  EXPECT_EQ(fine.half_width.z(), config.genetic.resolution_rad);
  const MatchTask wide = match_task(config, predicted(50.0, 50.0));
  EXPECT_EQ(wide.half_width.x(), config.largest_half_width_m);
  EXPECT_EQ(wide.half_width.z(), config.largest_half_width_rad);
}

TEST(SearchSpace, CarriesTheSettings) {
  LocalizerConfig config;
  config.solutions_wanted = 7;
  config.fitness_form = FitnessForm::kTopological;
  const MatchTask task = match_task(config, predicted(0.1, 0.1));
  EXPECT_EQ(task.solutions_wanted, 7U);
  EXPECT_EQ(task.fitness_form, FitnessForm::kTopological);
}

// Largest half-widths of 3 m and 3.1 rad: deviations of 1.2257 m and 1.0333 rad.
TEST(SearchSpace, APredictionIsSearchableUpToTheLargestWidth) {
  const LocalizerConfig config;
  EXPECT_TRUE(searchable(config, predicted(1.225, 0.1)));
  EXPECT_FALSE(searchable(config, predicted(1.227, 0.1)));
  EXPECT_TRUE(searchable(config, predicted(0.1, 1.033)));
  EXPECT_FALSE(searchable(config, predicted(0.1, 1.034)));
}

TEST(SearchSpace, NothingBeyondTheLargestCostIsSearchable) {
  const LocalizerConfig config;
  const double largest = largest_searchable_cost(config);
  for (const auto& pose : {predicted(1.2257, 1.0334), predicted(0.01, 1.5), predicted(2.0, 0.01)}) {
    if (PoseGraph::path_cost(pose.covariance) > largest) {
      EXPECT_FALSE(searchable(config, pose));
    }
  }
  EXPECT_NEAR(largest, PoseGraph::path_cost(predicted(1.2257, 3.1 / 3.0).covariance), 0.01);
}

}  // namespace
}  // namespace topogeo::localization
