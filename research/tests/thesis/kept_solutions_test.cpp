// Stops that see nodes alone, each map in another pattern; the last stop is at the place of the
// first one, where odometry does not have it.
#include "topogeo/thesis/kept_solutions.hpp"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "localization/hand_scenes.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

constexpr std::uint32_t kKeptStops = 9;  // 8 m apart: the first stop is not recent at the last one

/// Nodes on both sides of the path, as far apart as no other map has them.
std::shared_ptr<const topomap::LocalMap> map_of(std::uint32_t id, std::uint32_t place) {
  auto map = std::make_shared<topomap::LocalMap>();
  map->robot_id = "robot";
  map->id = id;
  map->T_odom_robot = {1.0 * id, 0.0, 0.0};
  const double clearance_m = 0.6 + 0.9 * place;
  map->nodes = {test::node(1.0, -1.0, clearance_m), test::node(2.5, 1.2, clearance_m),
                test::node(3.0, -0.4, clearance_m)};
  return map;
}

ThesisSlamConfig config_of() {
  ThesisSlamConfig config;
  config.evidence = MatchEvidence::kFitness;
  config.thesis.kept_solutions = 3;
  return config;
}

struct Round {
  ThesisSlamConfig config = config_of();
  ThesisMap map{config, 40};
  KeptSolutions kept{config};

  Round() {
    for (std::uint32_t id = 0; id < kKeptStops; ++id) {
      map.append(map_of(id, id + 1 == kKeptStops ? 0 : id));
      if (id == 0) {
        map.place_first();
      } else {
        map.place(id - 1, map.stop(id).T_previous_this, false);
      }
      kept.add_stop(map);
    }
  }

  /// All stops by odometry, except the last one.
  [[nodiscard]] CycleSolution ending_at(const Pose2& T_map_last) const {
    CycleSolution solution{map.poses(), 0, kKeptStops - 1, 0.0};
    solution.T_map_stop.back() = T_map_last;
    return solution;
  }
};

TEST(KeptSolutions, WithoutACycleThereIsNone) {
  const Round round;
  EXPECT_TRUE(round.kept.all().empty());
  EXPECT_EQ(round.kept.best(), nullptr);
}

TEST(KeptSolutions, TheBestIsWhereTheMapsLieOnEachOther) {
  Round round;
  round.kept.offer(round.map, {round.ending_at({0.4, 0.1, 0.0}), round.ending_at({0.0, 0.0, 0.0}),
                               round.ending_at({2.0, 0.0, 1.0})});
  ASSERT_NE(round.kept.best(), nullptr);
  EXPECT_EQ(round.kept.best()->T_map_stop.back(), Pose2{});
  EXPECT_NEAR(round.kept.best()->agreement, 1.0, 0.01);
  EXPECT_EQ(round.kept.all().size(), 3U);
}

TEST(KeptSolutions, OneThatAgreesTooLittleIsNotUsed) {
  Round round;
  round.kept.offer(round.map, {round.ending_at({0.4, 0.1, 0.0})});
  EXPECT_EQ(round.kept.all().size(), 1U);
  EXPECT_EQ(round.kept.best(), nullptr);
}

TEST(KeptSolutions, KeepsDistinctOnesUpToTheLimit) {
  Round round;
  round.kept.offer(round.map, {round.ending_at({0.0, 0.0, 0.0}), round.ending_at({0.05, 0.0, 0.0}),
                               round.ending_at({0.4, 0.0, 0.0}), round.ending_at({0.0, 0.5, 0.0}),
                               round.ending_at({0.0, 1.0, 0.0})});
  EXPECT_EQ(round.kept.all().size(), 3U);
  EXPECT_EQ(round.kept.all().front().T_map_stop.back(), Pose2{});
}

TEST(KeptSolutions, FollowTheForwardStepsOfTheRobot) {
  Round round;
  round.kept.offer(round.map, {round.ending_at({0.0, 0.0, 0.0})});
  round.map.append(map_of(kKeptStops, 1));
  round.map.place(kKeptStops - 1, round.map.stop(kKeptStops).T_previous_this, false);
  round.kept.add_stop(round.map);
  ASSERT_NE(round.kept.best(), nullptr);
  EXPECT_NEAR(round.kept.best()->T_map_stop.back().x_m, 1.0, 1e-9);
  EXPECT_NEAR(round.kept.best()->agreement, 2.0, 0.05);  // the second map is seen again, too
}

TEST(KeptSolutions, RefiningMovesTheStopsToWhereTheyAgreeBest) {
  Round round;
  round.kept.offer(round.map, {round.ending_at({0.06, -0.05, 0.02})});
  round.kept.refine(round.map);
  ASSERT_NE(round.kept.best(), nullptr);
  const Pose2& last = round.kept.best()->T_map_stop.back();
  EXPECT_LT(last.position_m().norm(), 0.02);
  EXPECT_NEAR(last.theta_rad, 0.0, 0.005);
  EXPECT_EQ(round.kept.best()->T_map_stop[kKeptStops - 2], round.map.poses()[kKeptStops - 2]);
}

}  // namespace
}  // namespace topogeo::localization
