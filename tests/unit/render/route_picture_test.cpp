// Pictures of routes on a floor of 4 x 4 m.
#include "topogeo/render/route_picture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::render {
namespace {

using testing::HasSubstr;
using testing::Not;

planning::HybridMap floor_4m() {
  planning::GridFrame frame;
  frame.columns = frame.rows = 40;
  planning::FreeSpace space(planning::OccupancyGrid(frame, planning::CellState::kFree));
  planning::ZoneMap zones = planning::zones_by_width(space);
  return {std::move(space), std::move(zones)};
}

planning::HybridRoute route_on(planning::PlannedOn on) {
  planning::HybridRoute route;
  route.status = planning::RouteStatus::kFound;
  route.points_m = {{1.0, 1.0}, {3.0, 1.0}, {3.0, 3.0}};
  route.parts = {{planning::PlannedOn::kBranch, 1, 0}, {on, 2, 1}};
  return route;
}

std::string svg(const planning::HybridRoute& route, const topomap::GlobalMap* graph = nullptr) {
  return route_picture(floor_4m(), route, "title", PictureFormat::kSvg, {}, {}, graph);
}

TEST(RoutePicture, PartsOnVirtualBranchesAreDashedAndThoseOffBranchesDotted) {
  EXPECT_THAT(svg(route_on(planning::PlannedOn::kBranch)), Not(HasSubstr("stroke-dasharray")));
  EXPECT_THAT(svg(route_on(planning::PlannedOn::kVirtualBranch)), HasSubstr("stroke-dasharray"));
  EXPECT_THAT(svg(route_on(planning::PlannedOn::kOffBranch)), HasSubstr("stroke-dasharray"));
  EXPECT_NE(svg(route_on(planning::PlannedOn::kVirtualBranch)),
            svg(route_on(planning::PlannedOn::kOffBranch)));
}

TEST(RoutePicture, ShowsTheBranchesOfTheMap) {
  topomap::GlobalMap graph;
  topomap::MapBranch& branch = graph.branches.emplace_back();
  branch.points = {{{0.5, 0.5}, 0.5}, {{3.5, 3.5}, 0.5}};
  const std::string solid = svg(route_on(planning::PlannedOn::kBranch), &graph);
  EXPECT_NE(solid, svg(route_on(planning::PlannedOn::kBranch)));
  EXPECT_THAT(solid, Not(HasSubstr("stroke-dasharray")));
  branch.is_virtual = true;
  EXPECT_THAT(svg(route_on(planning::PlannedOn::kBranch), &graph), HasSubstr("stroke-dasharray"));
}

}  // namespace
}  // namespace topogeo::render
