// The search between two stops, against the truth of a simulated drive.
#include "topogeo/pipeline/stop_search.hpp"

#include <cmath>
#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::pipeline {
namespace {

using geometry::Pose2;

class StopSearchTest : public ::testing::Test {
 protected:
  StopSearchTest() {
    LocalMapper mapper(config_.local_mapper, "robot");
    for (std::size_t i = 0; i < log_.scans.size(); ++i) {
      std::optional<topomap::LocalMap> map = mapper.add(log_.scans[i]);
      if (!map) continue;
      stops_.push_back(
          topomap::numbered(std::move(*map), static_cast<std::uint32_t>(stops_.size()), false));
      T_world_stop_.push_back(log_.T_world_robot[i]);
    }
  }
  [[nodiscard]] Pose2 truth(std::size_t reference, std::size_t query) const {
    return geometry::between(T_world_stop_[reference], T_world_stop_[query]);
  }
  [[nodiscard]] localization::UncertainPose predicted(std::size_t reference,
                                                      std::size_t query) const {
    return predict_by_odometry(stops_, reference, query, config_.localizer.odometry);
  }

  Config config_ = load_config({}).config;
  simulation::SimulatedLog log_ = simulation::simulate_log(
      world::load_world(std::filesystem::path(TOPOGEO_SHARE) / "worlds/room.world.yaml"), {});
  std::vector<topomap::LocalMap> stops_;
  std::vector<Pose2> T_world_stop_;
};

TEST_F(StopSearchTest, FindsTheStopWhereItIs) {
  ASSERT_GT(stops_.size(), 4U);
  const StopSearch search = search_stop(stops_[1], stops_[3], predicted(1, 3), config_.localizer);
  ASSERT_EQ(search.result.status, localization::MatchStatus::kSolved);
  const Pose2 error = geometry::between(truth(1, 3), search.result.T_reference_query);
  EXPECT_LT(error.position_m().norm(), 0.05);
  EXPECT_LT(std::fabs(error.theta_rad), 0.02);
  ASSERT_EQ(search.solutions.size(), search.result.solutions.size());
  EXPECT_DOUBLE_EQ(search.refined.scan, search.result.scan_fitness);
  EXPECT_DOUBLE_EQ(search.refined.topological, search.result.topological_fitness);
  EXPECT_GT(search.refined.prior, 0.0);
  EXPECT_LE(search.refined.prior, 1.0);
  EXPECT_GE(search.ellipse.semi_major_m, search.ellipse.semi_minor_m);
}

TEST_F(StopSearchTest, OdometryBackIsTheInverseOfOdometryForth) {
  const localization::UncertainPose forth = predicted(0, 4);
  const localization::UncertainPose back = inverse(predicted(4, 0));
  EXPECT_NEAR((forth.T_a_b.position_m() - back.T_a_b.position_m()).norm(), 0.0, 1e-9);
  EXPECT_TRUE(forth.covariance.isApprox(back.covariance, 1e-6));
  const Pose2 by_odometry = geometry::between(stops_[0].T_odom_robot, stops_[4].T_odom_robot);
  EXPECT_NEAR((forth.T_a_b.position_m() - by_odometry.position_m()).norm(), 0.0, 1e-9);
}

TEST_F(StopSearchTest, NamesWhatCannotBeSearched) {
  EXPECT_THROW(static_cast<void>(predicted(1, stops_.size())), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(predicted(2, 2)), std::invalid_argument);
  stops_[2].starts_drive = true;
  EXPECT_THROW(static_cast<void>(predicted(1, 3)), std::invalid_argument);
  EXPECT_NO_THROW(static_cast<void>(predicted(2, 3)));
}

}  // namespace
}  // namespace topogeo::pipeline
