#include "topogeo/thesis/thesis_matching.hpp"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

using geometry::Pose2;

/// Matches every pair at its predicted pose.
class AgreeingPool : public MatchPool {
 public:
  void add_map(std::shared_ptr<const topomap::LocalMap> map) override { known.push_back(map->id); }
  std::vector<MatchResult> match(std::span<const MatchTask> tasks) override {
    std::vector<MatchResult> results;
    for (const MatchTask& task : tasks) {
      asked.push_back(task);
      MatchResult& result = results.emplace_back();
      result.status = MatchStatus::kSolved;
      result.T_reference_query = task.T_reference_query;
      result.covariance = 0.01 * Eigen::Matrix3d::Identity();
      result.solutions = {{task.T_reference_query, 0.8}};
    }
    return results;
  }
  std::vector<std::uint32_t> known;
  std::vector<MatchTask> asked;
};

class ThesisMatchingTest : public ::testing::Test {
 protected:
  void add_stop() {
    auto map = std::make_shared<topomap::LocalMap>();
    map->robot_id = "robot";
    map->id = static_cast<std::uint32_t>(map_.size());
    map->T_odom_robot = {1.0 * map->id, 0.0, 0.0};
    map_.append(map);
    if (map->id == 0) {
      map_.place_first();
    } else {
      map_.place(map->id - 1, map_.stop(map->id).T_previous_this, false);
    }
    matching_.add(map_);
  }
  static ThesisNeighbour neighbour(std::uint32_t id, double x_m) {
    return {id, {{x_m, 0.0, 0.0}, 0.01 * Eigen::Matrix3d::Identity()}, 0.8};
  }

  AgreeingPool pool_;
  ThesisMap map_{LocalizerConfig{}, 40};
  ThesisMatching matching_{LocalizerConfig{}, pool_};
};

TEST_F(ThesisMatchingTest, MatchesTheLastStopWithItsNeighbours) {
  add_stop();
  add_stop();
  EXPECT_EQ(pool_.known, (std::vector<std::uint32_t>{0, 1}));
  const std::vector with{neighbour(0, -1.0)};
  const std::vector<ThesisMatch> matches = matching_.match(map_, with, 40);
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].earlier, 0U);
  EXPECT_NEAR(matches[0].T_earlier_new.T_a_b.x_m, 1.0, 1e-12);
  ASSERT_EQ(pool_.asked.size(), 1U);
  EXPECT_EQ(pool_.asked[0].reference_map_id, 1U);
  EXPECT_EQ(pool_.asked[0].solutions_wanted, 40U);
  EXPECT_TRUE(pool_.asked[0].initial_individuals.empty());
  EXPECT_EQ(matching_.counts().tasks, 1U);
}

TEST_F(ThesisMatchingTest, StartsFromTheSolutionsThatItRemembers) {
  add_stop();
  add_stop();
  matching_.remember(matching_.match(map_, std::vector{neighbour(0, -1.0)}, 3));
  add_stop();
  matching_.match(map_, std::vector{neighbour(0, -2.0), neighbour(1, -1.0)}, 3);
  ASSERT_EQ(pool_.asked.size(), 3U);
  ASSERT_EQ(pool_.asked[1].initial_individuals.size(), 1U);
  EXPECT_NEAR(pool_.asked[1].initial_individuals[0].x_m, -2.0, 1e-9);
  EXPECT_TRUE(pool_.asked[2].initial_individuals.empty());
  matching_.remember({});
  matching_.match(map_, std::vector{neighbour(0, -2.0)}, 3);
  EXPECT_TRUE(pool_.asked[3].initial_individuals.empty());
}

TEST_F(ThesisMatchingTest, WithoutNeighboursNothingIsAsked) {
  add_stop();
  add_stop();
  EXPECT_TRUE(matching_.match(map_, {}, 3).empty());
  EXPECT_TRUE(pool_.asked.empty());
}

}  // namespace
}  // namespace topogeo::localization
