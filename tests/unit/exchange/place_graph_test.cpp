#include "topogeo/exchange/place_graph.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sample_floor.hpp"

namespace topogeo::exchange {
namespace {

TEST(PlaceGraph, KnowsWhereClearancesAreMissing) {
  topomap::GlobalMap map = sample_graph();
  EXPECT_FALSE(lacks_clearances(map));
  EXPECT_FALSE(lacks_clearances({}));
  map.branches[0].points[1].clearance_m = 0.0;
  EXPECT_FALSE(lacks_clearances(map)) << "it is narrow there";
  for (topomap::BranchPoint& point : map.branches[0].points) point.clearance_m = 0.0;
  EXPECT_TRUE(lacks_clearances(map));
  map = sample_graph();
  map.nodes[1].clearance_m = 0.0;
  EXPECT_TRUE(lacks_clearances(map));
}

MapGraph whole_sample() {
  MapGraph graph{sample_graph(), sample_drawing(), {}};
  graph.drawing.grid = sample_space().grid();
  return graph;
}

TEST(PlaceGraph, EverythingMovesTogetherAndBack) {
  const geometry::Pose2 T{3.0, -2.0, 1.2};
  MapGraph graph = whole_sample();
  move(graph, T);
  EXPECT_LT((graph.map.nodes[1].position_m - T * Eigen::Vector2d(4.0, 0.5)).norm(), 1e-12);
  EXPECT_LT((graph.drawing.places[0].position_m - T * Eigen::Vector2d(0.0, -0.6)).norm(), 1e-12);
  // The lane rotates with the map: 3 + 1.2 rad, wrapped.
  EXPECT_NEAR(graph.drawing.zones[3].value, 4.2 - 2.0 * 3.14159265358979, 1e-12);
  EXPECT_EQ(graph.drawing.zones[2].value, 0.35);
  move(graph, geometry::inverse(T));
  const MapGraph before = whole_sample();
  for (std::size_t i = 0; i < before.map.branches.size(); ++i) {
    for (std::size_t k = 0; k < before.map.branches[i].points.size(); ++k) {
      EXPECT_LT(
          (graph.map.branches[i].points[k].position_m - before.map.branches[i].points[k].position_m)
              .norm(),
          1e-12);
    }
  }
  EXPECT_NEAR(graph.drawing.grid->frame().T_map_grid.x_m, -1.0, 1e-12);
  EXPECT_TRUE(std::ranges::equal(graph.drawing.grid->cells(), before.drawing.grid->cells()));
}

TEST(PlaceGraph, ClearancesThatAreMissingComeFromTheGrid) {
  topomap::GlobalMap map = sample_graph();
  for (topomap::BranchPoint& p : map.branches[0].points) p.clearance_m = 0.0;
  const planning::FreeSpace space = sample_space();
  take_clearances(map, space);
  // The wall is the column around x = -0.95; cells end at multiples of 0.1 m.
  EXPECT_NEAR(map.branches[0].points[1].clearance_m, 2.95, 0.1);
  EXPECT_EQ(map.branches[1].points[1].clearance_m, 0.8);
}

TEST(PlaceGraph, AMapKeepsTheGraphOfItsStops) {
  storage::MapDocument document;
  document.drawing.places = {{"Küche", {1.0, 1.0}}, {"bath", {2.0, 2.0}}};
  Notes notes;
  lay_over(document, whole_sample(), notes);
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(document.global_map.nodes.size(), 4U);
  EXPECT_EQ(document.trajectory.version, 12U);
  ASSERT_EQ(document.drawing.places.size(), 3U);
  EXPECT_EQ(document.drawing.places[0].position_m.x(), 8.0);
  EXPECT_TRUE(document.drawing.grid);
  MapGraph other = whole_sample();
  other.map.nodes.resize(1);
  other.map.branches.clear();
  document.local_maps.emplace_back();
  lay_over(document, MapGraph(other), notes);
  EXPECT_THAT(notes, testing::ElementsAre("1 nodes and 0 branches left out: the map has nodes of "
                                          "its own stops"));
  EXPECT_EQ(document.global_map.nodes.size(), 4U);
  // The graph of a grid alone gives way.
  document.local_maps.clear();
  notes.clear();
  lay_over(document, std::move(other), notes);
  EXPECT_THAT(notes, testing::ElementsAre(testing::HasSubstr("4 nodes and 5 branches of the map")));
  EXPECT_EQ(document.global_map.nodes.size(), 1U);
}

}  // namespace
}  // namespace topogeo::exchange
