// The second solution of a match: another place that the maps also support.
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "topogeo/matching/match_gate.hpp"
#include "topogeo/matching/matcher.hpp"

#include "localization/hand_scenes.hpp"
#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

topomap::LocalMap map_seen_from(const world::World& world, const Pose2& T_world_robot,
                                std::uint32_t id) {
  topomap::LocalMap map;
  map.id = id;
  map.points = test::exact_points(world, T_world_robot);
  return map;
}

/// Pillars 2 m apart along one wall of an endless corridor.
///
///   ------------------------------
///        robot ->
///   --#-----#-----#-----#-----#---
world::World colonnade() {
  world::World world = test::endless_corridor();
  for (int i = -6; i <= 6; ++i) {
    const double x = 2.0 * i + 0.9;
    world.segments.push_back({{x, -1.0}, {x, -0.7}});
    world.segments.push_back({{x, -0.7}, {x + 0.2, -0.7}});
    world.segments.push_back({{x + 0.2, -0.7}, {x + 0.2, -1.0}});
  }
  return world;
}

struct Matched {
  MatchResult result;
  double rivalry = 0.0;
};

Matched match(const world::World& world, const Pose2& T_predicted, double sigma_m) {
  const topomap::LocalMap reference = map_seen_from(world, {}, 0);
  const topomap::LocalMap query = map_seen_from(world, {0.4, 0.1, 0.1}, 1);
  Matcher matcher;
  matcher.add_map(reference);
  matcher.add_map(query);
  const MatchTask task = test::task_between(reference, query, T_predicted, sigma_m, 0.1);
  const MatchResult result = matcher.solve(task);
  return {result, rivalry(task, result)};
}

TEST(MatchRivalsTest, APillarFartherOnIsOneWhereTheSearchAllowsIt) {
  // Half-width of 2.4 m: the truth and the pillars before and after it.
  const auto [wide, rivalry] = match(colonnade(), {0.4, 0.1, 0.1}, 1.0);
  EXPECT_NEAR(std::fabs(wide.second.T_reference_query.x_m - wide.T_reference_query.x_m), 2.0, 0.15);
  EXPECT_NEAR(wide.second.T_reference_query.y_m, wide.T_reference_query.y_m, 0.1);
  EXPECT_GT(rivalry, 0.75);
}

TEST(MatchRivalsTest, APillarFartherOnIsNoneWhereOdometryRulesItOut) {
  const auto [narrow, rivalry] = match(colonnade(), {0.4, 0.1, 0.1}, 0.1);
  EXPECT_LT(rivalry, 0.5);
  EXPECT_EQ(narrow.verdict, Verdict::kAccepted) << to_string(narrow.reason);
}

TEST(MatchRivalsTest, APredictionOnePillarOffIsAmbiguous) {
  // 2.2 m of search on both sides of the next pillar, which odometry predicts.
  const auto [off, rivalry] = match(colonnade(), {2.4, 0.1, 0.1}, 0.9);
  EXPECT_NEAR(off.T_reference_query.x_m, 2.4, 0.1);
  EXPECT_NEAR(off.second.T_reference_query.x_m, 0.4, 0.15) << "the truth";
  EXPECT_GT(rivalry, 1.0);
  EXPECT_EQ(off.verdict, Verdict::kAmbiguous) << to_string(off.reason);
}

TEST(MatchRivalsTest, ARoomHasNone) {
  const auto [room, rivalry] = match(test::l_room(), {0.5, 0.1, 0.1}, 0.5);
  EXPECT_GT(room.second.fitness, 0.0);
  EXPECT_LT(rivalry, 0.6);
  EXPECT_EQ(room.verdict, Verdict::kAccepted) << to_string(room.reason);
}

}  // namespace
}  // namespace topogeo::localization
