#include "topogeo/pipeline/hybrid_map_source.hpp"

#include <cmath>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/planning/grid_file.hpp"
#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/storage/map_file.hpp"

namespace topogeo::pipeline {
namespace {

using planning::CellState;
using testing::HasSubstr;
using testing::ThrowsMessage;

// Two rooms of 4 x 4 m side by side, a door of 1 m between them:
//     +--------+--------+
//     |                 |
//     |   A    |   B    |
//     +--------+--------+ 8
// The scan sees both from the door.
topomap::LocalMap scan_of_two_rooms() {
  topomap::LocalMap map;
  const auto add = [&](double x_m, double y_m) {
    map.points.push_back({static_cast<float>(x_m - 4.0), static_cast<float>(y_m - 2.0)});
  };
  for (int k = 0; k <= 160; ++k) {
    const double along_m = 0.05 * k;
    add(along_m, 0.0);
    add(along_m, 4.0);
    if (along_m > 4.0) continue;
    add(0.0, along_m);
    add(8.0, along_m);
    if (along_m < 1.5 || along_m > 2.5) add(4.0, along_m);
  }
  return map;
}

storage::MapDocument mapped_rooms() {
  storage::MapDocument document;
  document.robot_id = "robot";
  document.local_maps.push_back(scan_of_two_rooms());
  document.local_maps[0].robot_id = "robot";
  document.trajectory.stops.push_back({0, 0, {4.0, 2.0, 0.0}, Eigen::Matrix3d::Identity()});
  document.global_map.nodes = {{1, topomap::NodeKind::kReal, {2.0, 2.0}, 2.0, 3},
                               {2, topomap::NodeKind::kDoor, {4.0, 2.0}, 0.5, 3},
                               {3, topomap::NodeKind::kReal, {6.0, 2.0}, 2.0, 3}};
  document.global_map.branches = {{1, 1, 2, false, 3, {{{2.0, 2.0}, 2.0}, {{4.0, 2.0}, 0.5}}},
                                  {2, 2, 3, false, 3, {{{4.0, 2.0}, 0.5}, {{6.0, 2.0}, 2.0}}}};
  return document;
}

planning::OccupancyGrid drawn_grid(double x_m) {
  planning::GridFrame frame;
  frame.columns = 60;
  frame.rows = 60;
  frame.T_map_grid = {x_m, -1.0, 0.0};
  planning::OccupancyGrid grid(frame, CellState::kUnknown);
  for (std::int32_t row = 15; row < 45; ++row) {
    for (std::int32_t column = 15; column < 45; ++column) {
      grid.set({column, row}, CellState::kFree);
    }
  }
  return grid;
}

planning::ZoneId zone_at(const planning::HybridMap& map, double x_m, double y_m) {
  const auto cell = map.frame().cell_of({x_m, y_m});
  return cell ? map.zone_of(*cell) : planning::kNoZone;
}

TEST(HybridMapSource, AMapHasZonesBetweenItsPassages) {
  storage::MapDocument document = mapped_rooms();
  document.drawing.places = {{"room B", {6.0, 2.0}}};
  const planning::HybridMap map = make_hybrid_map(parts_of(document), {});
  EXPECT_EQ(map.zones().zones.size(), 2U);
  EXPECT_NE(zone_at(map, 2.0, 2.0), zone_at(map, 6.0, 2.0));
  ASSERT_EQ(map.nodes().size(), 1U);
  EXPECT_NEAR(map.nodes()[0].position_m.x(), 4.0, 0.15);
  const planning::HybridRoute route =
      planning::HybridPlanner(map).plan({1.0, 2.0}, std::string("room B"));
  EXPECT_TRUE(route.found()) << route.reason;
  EXPECT_NEAR(route.length_m, 5.0, 0.1);
}

TEST(HybridMapSource, WithoutPassagesZonesFollowFromTheWidth) {
  storage::MapDocument document = mapped_rooms();
  document.global_map = {};
  const planning::HybridMap map = make_hybrid_map(parts_of(document), {});
  EXPECT_NE(zone_at(map, 2.0, 2.0), zone_at(map, 6.0, 2.0));
}

TEST(HybridMapSource, DrawnZonesCountFirst) {
  storage::MapDocument document = mapped_rooms();
  document.drawing.zones = {{"both", {{0, 0}, {8, 0}, {8, 4}, {0, 4}}}};
  const planning::HybridMap map = make_hybrid_map(parts_of(document), {});
  ASSERT_EQ(map.zones().zones.size(), 1U);
  EXPECT_EQ(map.zones().zones[0].name, "both");
}

TEST(HybridMapSource, AGridOfScansBeginsAtWholeTiles) {
  const storage::MapDocument document = mapped_rooms();
  const planning::GridFrame frame = make_hybrid_map(parts_of(document), {}).frame();
  EXPECT_EQ(frame.T_map_grid.x_m, -64 * 0.1);
  EXPECT_EQ(frame.T_map_grid.y_m, -64 * 0.1);
  // Half a metre further to the left, cells in both maps stay in place.
  storage::MapDocument grown = document;
  grown.trajectory.stops[0].T_map_robot.x_m -= 0.5;
  EXPECT_EQ(make_hybrid_map(parts_of(grown), {}).frame().T_map_grid, frame.T_map_grid);
}

TEST(HybridMapSource, ADrawingAloneMakesAMap) {
  storage::MapDrawing drawing;
  drawing.grid = drawn_grid(0.0);
  HybridMapParts parts;
  parts.drawing = &drawing;
  const planning::HybridMap map = make_hybrid_map(parts, {});
  EXPECT_EQ(map.frame().columns, 60);
  EXPECT_EQ(map.zones().zones.size(), 1U);
  EXPECT_NE(zone_at(map, 3.0, 2.0), planning::kNoZone);
}

// The drawing shows a yard that the robot has not seen; its scans show the rooms.
TEST(HybridMapSource, DrawingAndMapAreOneMap) {
  storage::MapDocument document = mapped_rooms();
  document.drawing.grid = drawn_grid(-8.0);
  const planning::HybridMap map = make_hybrid_map(parts_of(document), {});
  const auto state = [&](double x_m, double y_m) {
    return map.space().grid().at(map.frame().cell_of({x_m, y_m}).value());
  };
  EXPECT_EQ(map.frame().T_map_grid, (geometry::Pose2{-8.0, -1.0, 0.0}));
  EXPECT_EQ(state(-5.0, 2.0), CellState::kFree);
  EXPECT_EQ(state(2.0, 2.0), CellState::kFree);
  EXPECT_EQ(state(8.02, 2.0), CellState::kOccupied);
  EXPECT_EQ(state(-1.0, 2.0), CellState::kUnknown);
}

TEST(HybridMapSource, NeedsAGridOrSomethingSeen) {
  storage::MapDocument document = mapped_rooms();
  EXPECT_TRUE(has_grid(parts_of(document)));
  document.trajectory.stops[0].located = false;
  EXPECT_FALSE(has_grid(parts_of(document)));
  document.drawing.grid = drawn_grid(0.0);
  EXPECT_TRUE(has_grid(parts_of(document)));
  document = mapped_rooms();
  document.local_maps[0].points.clear();
  EXPECT_FALSE(has_grid(parts_of(document)));
}

TEST(HybridMapSource, RefusesWhatMakesNoMap) {
  EXPECT_THAT([] { make_hybrid_map({}, {}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("no stop with scan points")));
  HybridMapConfig config;
  config.inflation.forbidden_cells = -1.0;
  const storage::MapDocument document = mapped_rooms();
  EXPECT_THAT([&] { make_hybrid_map(parts_of(document), config); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("forbidden_cells")));
}

class FloorFiles : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    directory_ =
        std::filesystem::path(testing::TempDir()) / (std::string("topogeo_floor_") + test->name());
    std::filesystem::create_directories(directory_);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  std::filesystem::path write(const std::string& name, const std::string& text) {
    std::ofstream(directory_ / name) << text;
    return directory_ / name;
  }

  std::filesystem::path directory_;
};

constexpr const char* kWorld =
    "walls:\n"
    "  - {from: [0, 0], to: [6, 0]}\n"
    "  - {from: [6, 0], to: [6, 4]}\n"
    "  - {from: [6, 4], to: [0, 4]}\n"
    "  - {from: [0, 4], to: [0, 0]}\n"
    "tour: [[1, 1]]\n"
    "places: [{name: desk, at: [5, 3]}]\n";

TEST_F(FloorFiles, AWorldHasItsPlaces) {
  const auto world = write("a.world.yaml", kWorld);
  const storage::MapDocument floor = read_floor(world, {}, 0.05);
  ASSERT_TRUE(floor.drawing.grid.has_value());
  EXPECT_EQ(floor.drawing.grid->frame().resolution_m, 0.05);
  ASSERT_EQ(floor.drawing.places.size(), 1U);
  EXPECT_EQ(floor.drawing.places[0].name, "desk");
  EXPECT_EQ(make_hybrid_map(parts_of(floor), {}).places().size(), 1U);
}

TEST_F(FloorFiles, ADrawingGoesWhereItIsPut) {
  const auto world = write("a.world.yaml", kWorld);
  const auto zones =
      write("zones.yaml", "zones: [{name: left, polygon: [[0, 0], [3, 0], [3, 4], [0, 4]]}]\n");
  const geometry::Pose2 T_map_drawing{-1.0, -2.0, 1.5707963267948966};
  const storage::MapDrawing drawing = read_drawing(world, zones, 0.1, T_map_drawing);
  // (5, 3) of the drawing is 5 m up and 3 m to the left.
  EXPECT_NEAR(drawing.places.at(0).position_m.x(), -4.0, 1e-12);
  EXPECT_NEAR(drawing.places.at(0).position_m.y(), 3.0, 1e-12);
  EXPECT_NEAR(drawing.zones.at(0).polygon_m.at(1).y(), 1.0, 1e-12);
  const auto cell = drawing.grid->frame().cell_of({-4.0, 3.0});
  ASSERT_TRUE(cell.has_value());
  EXPECT_EQ(drawing.grid->at(*cell), CellState::kFree);
  EXPECT_EQ(drawing.grid->at(drawing.grid->frame().cell_of({-1.0, 0.0}).value()),
            CellState::kOccupied);
}

TEST_F(FloorFiles, AGridFileAndAMapFileAreFloorsToo) {
  planning::write_grid(directory_ / "grid.yaml", drawn_grid(0.5));
  const storage::MapDocument grid = read_floor(directory_ / "grid.yaml", {}, 0.1);
  ASSERT_TRUE(grid.drawing.grid.has_value());
  EXPECT_TRUE(std::ranges::equal(grid.drawing.grid->cells(), drawn_grid(0.5).cells()));

  storage::MapDocument document = mapped_rooms();
  document.drawing.places = {{"room A", {2.0, 2.0}}, {"room B", {6.0, 2.0}}};
  storage::write_map_file(directory_ / "map.pb", document);
  const auto zones =
      write("names.yaml", "places: [{name: room A, at: [1, 1]}, {name: c, at: [1, 3]}]");
  const storage::MapDocument read = read_floor(directory_ / "map.pb", zones, 0.1);
  ASSERT_EQ(read.drawing.places.size(), 3U);
  EXPECT_EQ(read.drawing.places[0].position_m, Eigen::Vector2d(1.0, 1.0)) << "the file counts";
  EXPECT_EQ(read.drawing.places[2].name, "c");
  EXPECT_EQ(read.local_maps.size(), 1U);
}

TEST_F(FloorFiles, BadOnesAreNamed) {
  const auto message = [](const auto& call) {
    try {
      call();
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(message([&] { read_floor(directory_ / "none.world.yaml", {}, 0.1); }),
              HasSubstr("none.world.yaml: cannot be opened"));
  EXPECT_THAT(message([&] { read_floor(directory_ / "none.pb", {}, 0.1); }),
              HasSubstr("none.pb: cannot be opened"));
  const auto wide = write("wide.world.yaml", "segments: [[0, 0, 90000, 1]]\n");
  EXPECT_THAT(message([&] { read_floor(wide, {}, 0.1); }),
              HasSubstr("wide.world.yaml: grid: columns is"));
  const auto long_name =
      write("long.yaml", "places: [{name: " + std::string(70, 'x') + ", at: [0, 0]}]\n");
  EXPECT_THAT(message([&] { read_zones_and_places(long_name); }),
              HasSubstr("long.yaml: place 'xxx"));
  const auto world = write("a.world.yaml", kWorld);
  EXPECT_THAT(message([&] {
                read_drawing(world, {}, 0.1, {1e9, 0.0, 0.0});
              }),
              HasSubstr("a.world.yaml: "));
}

}  // namespace
}  // namespace topogeo::pipeline
