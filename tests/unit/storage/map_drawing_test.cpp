// Drawings on a map, in the map file and in the database.
#include "topogeo/storage/map_drawing.hpp"

#include <limits>

#include <gmock/gmock.h>

#include "topogeo/storage/map_database.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/hash.hpp"

#include "map_conversions.hpp"
#include "sample_map.hpp"

namespace topogeo::storage {
namespace {

using ::testing::HasSubstr;

constexpr std::uint64_t kSeed = 0xfedcba9876543210ULL;  // of the sample

planning::OccupancyGrid sample_grid() {
  planning::GridFrame frame;
  frame.columns = 130;
  frame.rows = 70;
  frame.resolution_m = 0.05;
  frame.T_map_grid = {-1.5, 2.25, 0.5};
  planning::OccupancyGrid grid(frame, planning::CellState::kFree);
  for (std::int32_t i = 0; i < 70; ++i) grid.set({i, i}, planning::CellState::kOccupied);
  for (std::int32_t i = 0; i < 130; ++i) grid.set({i, 3}, planning::CellState::kUnknown);
  return grid;
}

MapDrawing sample_drawing() {
  MapDrawing drawing;
  drawing.places = {{"room B", {1.0 / 3.0, -2.0}}, {"Küche", {-0.0, 1e6}, -0.0}};
  drawing.zones = {{"hall", {{0, 0}, {4, 0}, {4, 0.1}}},
                   {"room B", {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}},
                   {"stairs", {{5, 0}, {6, 0}, {6, 1}}, planning::ZoneKind::kNoGo},
                   {"ramp", {{7, 0}, {8, 0}, {8, 1}}, planning::ZoneKind::kSlow, 0.3},
                   {"lane", {{9, 0}, {10, 0}, {10, 1}}, planning::ZoneKind::kOneWay, -1.5}};
  drawing.lines = {{planning::LineKind::kWall, {{0, 0}, {4, 0}, {4, 1.0 / 3.0}}},
                   {planning::LineKind::kOpening, {{1, 0}, {2, 0}}},
                   {planning::LineKind::kDoor, {{4, 0}, {4, 0.25}}, "front door"}};
  drawing.grid = sample_grid();
  drawing.version = 7;
  return drawing;
}

void expect_equal(const MapDrawing& a, const MapDrawing& b) {
  ASSERT_EQ(a.places.size(), b.places.size());
  for (std::size_t i = 0; i < a.places.size(); ++i) {
    EXPECT_EQ(a.places[i].name, b.places[i].name);
    EXPECT_EQ(a.places[i].position_m, b.places[i].position_m);
    EXPECT_EQ(a.places[i].station_heading_rad, b.places[i].station_heading_rad);
  }
  ASSERT_EQ(a.zones.size(), b.zones.size());
  for (std::size_t i = 0; i < a.zones.size(); ++i) {
    EXPECT_EQ(a.zones[i].kind, b.zones[i].kind);
    EXPECT_EQ(a.zones[i].value, b.zones[i].value);
    EXPECT_EQ(a.zones[i].name, b.zones[i].name);
    EXPECT_EQ(a.zones[i].polygon_m, b.zones[i].polygon_m);
  }
  EXPECT_EQ(a.lines, b.lines);
  EXPECT_EQ(a.version, b.version);
  ASSERT_EQ(a.grid.has_value(), b.grid.has_value());
  if (!a.grid) return;
  EXPECT_EQ(a.grid->frame().columns, b.grid->frame().columns);
  EXPECT_EQ(a.grid->frame().rows, b.grid->frame().rows);
  EXPECT_EQ(a.grid->frame().resolution_m, b.grid->frame().resolution_m);
  EXPECT_EQ(a.grid->frame().T_map_grid, b.grid->frame().T_map_grid);
  EXPECT_TRUE(std::ranges::equal(a.grid->cells(), b.grid->cells()));
}

MapDocument document_with(const MapDrawing& drawing) {
  MapDocument document = sample_document(3);
  document.drawing = drawing;
  return document;
}

TEST(MapDrawingFile, GivesBackEveryField) {
  const std::string bytes = map_file_bytes(document_with(sample_drawing()));
  const MapDocument read = parse_map_file(bytes, "map.pb");
  expect_equal(read.drawing, sample_drawing());
  EXPECT_EQ(map_file_bytes(read), bytes);
}

TEST(MapDrawingFile, PartsMayBeMissing) {
  for (int missing = 0; missing < 4; ++missing) {
    MapDrawing drawing = sample_drawing();
    if (missing == 0) drawing.places.clear();
    if (missing == 1) drawing.zones.clear();
    if (missing == 2) drawing.grid.reset();
    if (missing == 3) drawing.lines.clear();
    expect_equal(parse_map_file(map_file_bytes(document_with(drawing)), "map.pb").drawing, drawing);
  }
}

TEST(MapDrawingFile, AMapWithoutDrawingIsTheFileThatItAlwaysWas) {
  const std::string bytes = map_file_bytes(sample_document(3));
  EXPECT_EQ(support::fnv1a(bytes), 13049591916190681692ULL);
  EXPECT_TRUE(parse_map_file(bytes, "map.pb").drawing.empty());
}

TEST(MapDrawingFile, AGridOfOneColourTakesFewBytes) {
  MapDrawing drawing;
  planning::GridFrame frame;
  frame.columns = frame.rows = 2000;
  drawing.grid = planning::OccupancyGrid(frame, planning::CellState::kFree);
  const std::string bytes = map_file_bytes(document_with(drawing));
  EXPECT_LT(bytes.size(), 10'000U);
  expect_equal(parse_map_file(bytes, "map.pb").drawing, drawing);
}

TEST(MapDrawingFile, RefusesWhatIsNoDrawing) {
  const auto refusal = [](auto change) {
    MapDocument document = document_with(sample_drawing());
    change(document.drawing);
    EXPECT_THROW(map_file_bytes(document), std::invalid_argument);
    return error_of([&] { check(document.drawing); });
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal([](MapDrawing& d) { d.places[0].name = ""; }),
              HasSubstr("place '': expected a name of 1 to 64 bytes"));
  EXPECT_THAT(refusal([](MapDrawing& d) { d.places[1].name = "room B"; }),
              HasSubstr("place 'room B': the name is taken"));
  EXPECT_THAT(refusal([](MapDrawing& d) { d.places[0].name = std::string(65, 'x'); }),
              HasSubstr("expected a name of 1 to 64 bytes"));
  EXPECT_THAT(refusal([](MapDrawing& d) { d.places[0].name = "a\nb"; }),
              HasSubstr("printable UTF-8"));
  EXPECT_THAT(refusal([](MapDrawing& d) { d.zones[0].name = "caf\xe9"; }),
              HasSubstr("printable UTF-8"));
  EXPECT_THAT(refusal([](MapDrawing& d) { d.places[0].station_heading_rad = 3.2; }),
              HasSubstr("place 'room B': heading 3.2, expected -pi to pi"));
  EXPECT_THAT(refusal([](MapDrawing& d) { d.places[0].station_heading_rad = double{kNan}; }),
              HasSubstr("place 'room B': heading nan"));
  EXPECT_THAT(refusal([](MapDrawing& d) { d.places[0].position_m.x() = kNan; }),
              HasSubstr("place 'room B': coordinate nan"));
  EXPECT_THAT(refusal([](MapDrawing& d) { d.zones[1].polygon_m[0].y() = 2e6; }),
              HasSubstr("zone 'room B': coordinate 2000000"));
  EXPECT_THAT(refusal([](MapDrawing& d) { d.zones[3].value = kNan; }),
              HasSubstr("zone 'ramp': its value is not a finite number"));
  EXPECT_THAT(refusal([](MapDrawing& d) { d.zones[0].polygon_m.pop_back(); }),
              HasSubstr("zone 'hall': 2 corners, expected 3 to"));
  EXPECT_THAT(refusal([](MapDrawing& d) { d.lines[0].points_m.resize(1); }),
              HasSubstr("wall '': 1 points, expected 2 to"));
  EXPECT_THAT(refusal([](MapDrawing& d) { d.lines[1].points_m[0].x() = kNan; }),
              HasSubstr("opening '': coordinate nan"));
  EXPECT_THAT(refusal([](MapDrawing& d) {
                d.lines[1].points_m.push_back({3, 3});
              }),
              HasSubstr("opening '': expected two points that differ"));
  EXPECT_THAT(refusal([](MapDrawing& d) { d.lines[2].points_m[1] = d.lines[2].points_m[0]; }),
              HasSubstr("door 'front door': expected two points that differ"));
  EXPECT_THAT(refusal([](MapDrawing& d) { d.lines[2].name = ""; }),
              HasSubstr("door '': expected a name"));
  EXPECT_THAT(refusal([](MapDrawing& d) {
                for (int i = 0; i < 5000; ++i) d.places.push_back({std::to_string(i), {0, 0}});
              }),
              HasSubstr("5002 places, expected at most 4096"));
}

TEST(MapDrawingFile, AnEntryIsFoundByItsListAndPlace) {
  MapDrawing drawing = sample_drawing();
  drawing.lines.push_back(drawing.lines[2]);
  try {
    check(drawing);
    FAIL() << "the name of the door is taken";
  } catch (const DrawingError& error) {
    EXPECT_EQ(located(error), "doors[1]: door 'front door': the name is taken");
  }
}

TEST(MapDrawingFile, RefusesACorruptGrid) {
  proto::Drawing good;
  to_proto(sample_drawing(), &good);
  expect_equal(from_proto(good), sample_drawing());
  const auto refusal = [&](auto change) {
    proto::Drawing changed = good;
    change(*changed.mutable_grid());
    return error_of([&] { static_cast<void>(from_proto(changed)); });
  };
  const std::string cells = good.grid().cells();
  EXPECT_THAT(refusal([](proto::DrawnGrid& g) { g.set_columns(0); }),
              HasSubstr("drawn grid: columns is 0, expected 1 to 20000"));
  EXPECT_THAT(refusal([](proto::DrawnGrid& g) { g.set_rows(0xffffffffU); }),
              HasSubstr("drawn grid: rows is"));
  EXPECT_THAT(refusal([](proto::DrawnGrid& g) { g.set_resolution_m(0.0); }),
              HasSubstr("drawn grid: resolution_m is 0"));
  EXPECT_THAT(refusal([](proto::DrawnGrid& g) { g.mutable_t_map_grid()->set_x_m(1.0 / 0.0); }),
              HasSubstr("origin of the drawn grid is not a finite number"));
  // A few bytes that claim to be a hundred million cells are refused before memory is allocated.
  EXPECT_THAT(refusal([](proto::DrawnGrid& g) {
                g.set_columns(10000);
                g.set_rows(10000);
              }),
              HasSubstr("too few for 100000000 cells"));
  for (const int more : {-1, 1}) {  // fewer or more rows than the bytes contain
    EXPECT_THAT(
        refusal([&](proto::DrawnGrid& g) { g.set_rows(static_cast<std::uint32_t>(70 + more)); }),
        HasSubstr("cells in the format of zlib"));
  }
  EXPECT_THAT(refusal([&](proto::DrawnGrid& g) { g.set_cells(cells + "x"); }),
              HasSubstr("cells in the format of zlib"));
  EXPECT_THAT(refusal([&](proto::DrawnGrid& g) { g.set_cells(std::string(200, 'x')); }),
              HasSubstr("cells in the format of zlib"));
  for (std::size_t size = 10; size < cells.size(); size += 7) {
    EXPECT_NE(refusal([&](proto::DrawnGrid& g) { g.set_cells(cells.substr(0, size)); }), "");
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {  // zlib's checksum finds every change
    std::string changed = cells;
    changed[i] = static_cast<char>(changed[i] ^ 0x04);
    EXPECT_NE(refusal([&](proto::DrawnGrid& g) { g.set_cells(changed); }), "") << i;
  }
}

TEST(MapDrawingFile, RefusesACellThatIsNoState) {
  MapDrawing drawing = sample_drawing();
  drawing.grid->set({5, 1}, static_cast<planning::CellState>(7));
  proto::Drawing message;
  to_proto(drawing, &message);
  EXPECT_THAT(error_of([&] { static_cast<void>(from_proto(message)); }),
              HasSubstr("drawn grid: cell 135 is 7, expected 0 to 2"));
}

TEST(MapDrawingFile, RefusesAPolygonOfHalfACorner) {
  proto::Drawing message;
  to_proto(sample_drawing(), &message);
  message.mutable_zones(0)->add_corners(1.0);
  EXPECT_THAT(error_of([&] { static_cast<void>(from_proto(message)); }),
              HasSubstr("zone 'hall' with 7 numbers: expected two per corner"));
}

class MapDrawingDatabase : public ScratchDirectory {
 protected:
  [[nodiscard]] MapDatabase open() const {
    return MapDatabase::open_or_create(directory_ / "map.db", "robot-1", kSeed);
  }
};

TEST_F(MapDrawingDatabase, KeepsTheNewest) {
  open().put_drawing({});
  EXPECT_TRUE(open().load().drawing.empty());
  open().put_drawing(sample_drawing());
  expect_equal(open().load().drawing, sample_drawing());
  MapDrawing changed = sample_drawing();
  changed.places.pop_back();
  changed.grid.reset();
  MapDatabase database = open();
  database.put_drawing(changed);
  expect_equal(database.load().drawing, changed);
  changed.places[0].name.clear();
  EXPECT_THROW(database.put_drawing(changed), std::invalid_argument);
  EXPECT_EQ(database.load().drawing.places.size(), 1U);
}

}  // namespace
}  // namespace topogeo::storage
