#include "topogeo/exchange/inspect.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sample_floor.hpp"
#include "sample_stops.hpp"

namespace topogeo::exchange {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Inspect, CountsWhatIsThere) {
  storage::MapDocument document = sample_stops();
  document.global_map = sample_graph();
  document.drawing = sample_drawing();
  const MapSummary s = summarize(document);
  EXPECT_EQ(s.robot_id, "robot-1");
  EXPECT_EQ(s.sessions, 2U);
  EXPECT_EQ(s.stops, 6U);
  EXPECT_EQ(s.located_stops, 5U);
  EXPECT_EQ(s.loops, 1U);
  EXPECT_EQ(s.node_count(), 4U);
  EXPECT_THAT(s.nodes, ElementsAre(1, 1, 0, 1, 0, 1));
  EXPECT_EQ(s.branches, 5U);
  EXPECT_EQ(s.virtual_branches, 1U);
  EXPECT_EQ(s.places, 2U);
  EXPECT_EQ(s.zones, 4U);
  // Three steps of 1 m in the first drive; the second has one stop with a pose, and the jump to it
  // was not driven.
  EXPECT_NEAR(s.driven_m, 3.0, 1e-9);
  EXPECT_EQ(s.map_version, 12U);
  EXPECT_TRUE(s.has_extent);
  EXPECT_LE(s.low_m.y(), -2.0);
  EXPECT_GE(s.high_m.x(), 9.5);
  EXPECT_THAT(summary_text(s, 77), HasSubstr("6 in 2 sessions, 5 with a pose"));
  EXPECT_THAT(summary_text(s, 77), HasSubstr("size       77 bytes"));
  EXPECT_THAT(summary_json(s, 77), HasSubstr("\"hall_corridor\": 1"));
}

TEST(Inspect, AnEmptyMapHasNoExtent) {
  const MapSummary s = summarize({});
  EXPECT_FALSE(s.has_extent);
  EXPECT_EQ(s.sessions, 0U);
  EXPECT_THAT(summary_json(s, 0), HasSubstr("\"extent_m\": null"));
}

TEST(Inspect, FindsEachContradictionAndNothingInAGoodMap) {
  storage::MapDocument good = sample_stops();
  good.global_map = sample_graph();
  good.trajectory.version = 12;
  EXPECT_THAT(contradictions(good), IsEmpty());
  const auto found = [&](const auto& break_it) {
    storage::MapDocument bad = good;
    break_it(bad);
    const auto lines = contradictions(bad);
    return lines.empty() ? std::string() : lines.front();
  };
  EXPECT_THAT(found([](auto& d) { d.local_maps[2].stamp_ns = 1; }),
              HasSubstr("stop 2: stamp 1 ns"));
  EXPECT_THAT(found([](auto& d) { d.trajectory.stops[1].stamp_ns = 5; }),
              HasSubstr("stop 1: stamp 5 ns, its local map has"));
  EXPECT_THAT(found([](auto& d) { d.trajectory.stops[1].T_map_robot.x_m = 1e9; }),
              HasSubstr("stop 1: at (1e+09"));
  EXPECT_THAT(found([](auto& d) { d.trajectory.stops[1].covariance(0, 0) = -1.0; }),
              HasSubstr("stop 1: its covariance is not positive semidefinite"));
  EXPECT_THAT(found([](auto& d) { d.trajectory.stops[1].covariance(0, 1) = 3.0; }),
              HasSubstr("stop 1: its covariance is not positive semidefinite"));
  EXPECT_THAT(found([](auto& d) { d.trajectory.stops[3].located = false; }),
              HasSubstr("loop closure 0-3: stop 3 has no pose"));
  EXPECT_THAT(found([](auto& d) { d.global_map.branches[1].points.back().position_m.x() += 0.1; }),
              HasSubstr("branch 3: ends 0.100 m from its node 9"));
  EXPECT_THAT(found([](auto& d) { d.global_map.nodes[0].clearance_m = -1.0; }),
              HasSubstr("node 2: clearance -1 m"));
  EXPECT_THAT(found([](auto& d) { d.trajectory.version = 3; }), HasSubstr("map version 12"));
}

TEST(Inspect, ListsAtMostWhatIsAskedFor) {
  storage::MapDocument bad = sample_stops();
  for (auto& stop : bad.trajectory.stops) stop.covariance(2, 2) = -1.0;
  EXPECT_EQ(contradictions(bad, 2).size(), 2U);
}

}  // namespace
}  // namespace topogeo::exchange
