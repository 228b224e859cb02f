#include "topogeo/pipeline/world_grid.hpp"

#include <gtest/gtest.h>

#include "topogeo/planning/hybrid_planner.hpp"

namespace topogeo::pipeline {
namespace {

using planning::CellState;

TEST(WorldGrid, IsFreeInsideAndUnknownBehindTheWalls) {
  const world::World world = world::parse_world(
      "walls:\n"
      "  - {from: [0, 0], to: [6, 0]}\n"
      "  - {from: [6, 0], to: [6, 4]}\n"
      "  - {from: [6, 4], to: [0, 4]}\n"
      "  - {from: [0, 4], to: [0, 0]}\n"
      "  - {from: [3, 0], to: [3, 4], doors: [{at: 2, width: 1, open: [[5, 10]]}]}\n"
      "columns: [{center: [1.5, 2], radius: 0.3}]\n"
      "tour: [[0.5, 0.5]]\n",
      "world");
  const planning::OccupancyGrid grid = planning::grid_of(drawing_of(world));
  const auto at = [&](double x_m, double y_m) {
    return grid.at(grid.frame().cell_of({x_m, y_m}).value());
  };
  EXPECT_EQ(at(0.55, 3.55), CellState::kFree);
  EXPECT_EQ(at(1.55, 2.05), CellState::kOccupied);
  EXPECT_EQ(at(3.05, 2.05), CellState::kOccupied) << "the door is shut at the start";
  EXPECT_EQ(at(4.55, 2.05), CellState::kUnknown);
  EXPECT_EQ(at(-0.55, 2.05), CellState::kUnknown);
}

// Any two points on the tour of the office floor have a route, hardly longer than the shortest one.
TEST(WorldGrid, HasWaysBetweenAllPlacesOfATour) {
  const world::World world =
      world::load_world(std::string(TOPOGEO_SHARE) + "/worlds/floor.world.yaml");
  const planning::FreeSpace space(planning::grid_of(drawing_of(world)));
  const planning::HybridMap map(space, planning::zones_by_width(space));
  EXPECT_GT(map.zones().zones.size(), 10U);
  const planning::HybridPlanner planner(map);
  for (std::size_t i = 1; i < world.tour_m.size(); ++i) {
    const auto& from_m = world.tour_m[i];
    const auto& to_m = world.tour_m[(i * 7) % world.tour_m.size()];
    const planning::HybridRoute route = planner.plan(from_m, to_m);
    ASSERT_TRUE(route.found()) << route.reason;
    const planning::HybridRoute best = planning::plan_on_grid(space, from_m, to_m);
    EXPECT_LE(route.cost_m, 1.05 * best.cost_m + 1e-9);
  }
}

}  // namespace
}  // namespace topogeo::pipeline
