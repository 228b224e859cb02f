// A corridor seen from stops along it.
#include "map_store/live_map.hpp"

#include <gtest/gtest.h>

#include "services/common/random_values.hpp"

namespace topogeo::map_store {
namespace {

/// A corridor 2 m wide, 6 m in each direction, with its middle line as the only branch.
topomap::LocalMap corridor(std::uint32_t id) {
  topomap::LocalMap map;
  map.id = id;
  topomap::LocalBranch branch;
  branch.node_a = 0;
  branch.node_b = 1;
  for (int i = -60; i <= 60; ++i) branch.points.push_back({{0.1 * i, 0.0}, 1.0});
  map.nodes = {{0, topomap::NodeKind::kFictitious, branch.points.front().position_m, 1.0, {}, true},
               {1, topomap::NodeKind::kFictitious, branch.points.back().position_m, 1.0, {}, true}};
  map.branches = {branch};
  for (int i = -60; i <= 60; ++i) {
    map.points.push_back({0.1F * static_cast<float>(i), i % 2 == 0 ? 1.0F : -1.0F});
  }
  return map;
}

class Live : public testing::Test {
 protected:
  Live() {
    for (std::uint32_t i = 0; i < 5; ++i) {
      maps_.push_back(corridor(i));
      stops_.push_back({i, 0, {1.0 * i, 0.0, 0.0}, Eigen::Matrix3d::Zero()});
    }
  }
  void work(LiveMap& live) {
    live.check(stops_);
    while (live.step(maps_, stops_)) {
    }
  }
  /// The map built from all local maps at once.
  [[nodiscard]] topomap::GlobalMap fused() const {
    topomap::GlobalMapBuilder builder;
    builder.rebuild(maps_, stops_);
    return builder.snapshot(1);
  }

  std::vector<topomap::LocalMap> maps_;
  std::vector<topomap::StopPose> stops_;
  LiveMap live_{topomap::GlobalMapConfig{}};
};

TEST_F(Live, StepsGiveTheSameAsAllAtOnce) {
  work(live_);
  EXPECT_EQ(live_.size(), 5U);
  EXPECT_EQ(live_.rebuilds(), 0U);
  ASSERT_FALSE(fused().branches.empty());
  EXPECT_TRUE(live_.snapshot(1) == fused());
}

TEST_F(Live, WaitsForPosesAndMaps) {
  EXPECT_FALSE(live_.step(maps_, {}));
  EXPECT_FALSE(live_.step({}, stops_));
  EXPECT_EQ(live_.size(), 0U);
}

TEST_F(Live, OtherNumbersStartAnew) {
  live_.renumber(7);
  EXPECT_EQ(live_.rebuilds(), 0U) << "nothing was there";
  work(live_);
  live_.renumber(7);
  EXPECT_EQ(live_.size(), 5U);
  maps_.erase(maps_.begin() + 1);
  stops_.erase(stops_.begin() + 1);
  live_.renumber(8);
  EXPECT_EQ(live_.size(), 0U);
  work(live_);
  EXPECT_EQ(live_.size(), 4U);
  EXPECT_TRUE(live_.snapshot(1) == fused());
}

TEST_F(Live, SmallCorrectionsStayLargerOnesStartAnew) {
  work(live_);
  stops_[2].T_map_robot.y_m += 0.04;
  work(live_);
  EXPECT_EQ(live_.rebuilds(), 0U);
  stops_[2].T_map_robot.y_m += 0.02;  // 6 cm in total
  work(live_);
  EXPECT_EQ(live_.rebuilds(), 1U);
  EXPECT_TRUE(live_.snapshot(1) == fused());
  stops_[1].T_map_robot.theta_rad += 0.02;
  work(live_);
  EXPECT_EQ(live_.rebuilds(), 2U);
  EXPECT_TRUE(live_.snapshot(1) == fused());
}

TEST_F(Live, NewStartIsFinishedBeforeTheNext) {
  work(live_);
  stops_[0].T_map_robot.x_m += 1.0;
  live_.check(stops_);
  ASSERT_TRUE(live_.step(maps_, stops_));
  stops_[0].T_map_robot.x_m += 1.0;
  live_.check(stops_);
  EXPECT_EQ(live_.rebuilds(), 1U);
  while (live_.step(maps_, stops_)) {
  }
  live_.check(stops_);
  EXPECT_EQ(live_.rebuilds(), 2U);
}

TEST_F(Live, MapThatCannotBeFusedIsLeftOut) {
  stops_[1].T_map_robot.x_m = 1e6;  // beyond the builder's 5 km
  ASSERT_TRUE(live_.step(maps_, stops_));
  EXPECT_THROW(live_.step(maps_, stops_), std::invalid_argument);
  while (live_.step(maps_, stops_)) {
  }
  EXPECT_EQ(live_.size(), 5U);
}

}  // namespace
}  // namespace topogeo::map_store
