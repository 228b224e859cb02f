// Files written by programs of earlier versions, kept unchanged.
#include <gmock/gmock.h>
#include <sqlite3.h>

#include "topogeo/storage/map_database.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/read_map.hpp"

#include "sample_map.hpp"

namespace topogeo::storage {
namespace {

using ::testing::HasSubstr;

/// Content of the golden files.
MapDocument golden_document() {
  MapDocument document = sample_document(5);
  document.local_maps[3].starts_drive = true;
  document.trajectory.stops[4].located = false;
  document.drawing.places = {{"room A", {1.5, 2.0}}};
  document.drawing.zones = {{"hall", {{0.0, 0.0}, {4.0, 0.0}, {4.0, 3.0}}}};
  planning::GridFrame frame;
  frame.columns = 3;
  frame.rows = 2;
  frame.resolution_m = 0.5;
  frame.T_map_grid = {1.0, 2.0, 0.5};
  planning::OccupancyGrid grid(frame);
  grid.set({1, 1}, planning::CellState::kOccupied);
  grid.set({0, 0}, planning::CellState::kFree);
  document.drawing.grid = grid;
  return document;
}

/// Additions of version 3.
planning::RoomMemory numbered_rooms() {
  const topomap::StopId stop{0xfedcba9876543210U, 2};
  planning::RoomMemory rooms;
  rooms.rooms = {{1, 40, {{stop, {1.0, -0.5}}, {std::nullopt, {4.0, 2.0}}}, "room A"},
                 {3, 12, {}, ""}};
  rooms.places = {{{"room A", {1.5, 2.0}}, 1, {stop, {0.25, 0.0}}, 0.75}};
  rooms.last = 4;
  return rooms;
}

class GoldenFile : public ScratchDirectory {
 protected:
  [[nodiscard]] std::filesystem::path path() const { return directory_ / "map.sqlite"; }
  void execute(const std::string& sql) const {
    sqlite3* handle = nullptr;
    ASSERT_EQ(sqlite3_open(path().c_str(), &handle), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(handle);
    sqlite3_close(handle);
  }
  void make(const std::string& name) const { execute(content(golden(name))); }
  static std::filesystem::path golden(const std::string& name) {
    return std::filesystem::path(TOPOGEO_TEST_DATA) / name;
  }
};

TEST_F(GoldenFile, MapFileOfBeforeIsRead) {
  EXPECT_EQ(map_file_bytes(read_map(golden("map_v1.pb"))), map_file_bytes(golden_document()));
}

TEST_F(GoldenFile, DatabaseOfVersion1IsMigrated) {
  make("map_v1.sql");
  const MapDocument expected = identified(golden_document());
  EXPECT_EQ(map_file_bytes(MapDatabase::open_existing(path()).load()), map_file_bytes(expected));
  // Migrates once for all, and the map can grow.
  MapDatabase database = MapDatabase::open_or_create(path(), "robot-1", expected.seed);
  EXPECT_EQ(map_file_bytes(database.load()), map_file_bytes(expected));
  EXPECT_EQ(database.map_id(), expected.map_id);
  const topomap::LocalMap next = sample_stop_of(99, 0);
  EXPECT_TRUE(database.put_stops({&next, 1}).empty());
  const JoinedStop joined{next.stop, true};
  database.join({&joined, 1});
  EXPECT_EQ(database.load().local_maps.size(), 6U);
}

TEST_F(GoldenFile, DatabaseOfVersion1IsReadWithoutAChange) {
  make("map_v1.sql");
  const std::string before = content(path());
  EXPECT_EQ(map_file_bytes(read_map(path())), map_file_bytes(identified(golden_document())));
  EXPECT_EQ(content(path()), before);
  for (const auto& entry : std::filesystem::directory_iterator(directory_)) {
    EXPECT_EQ(entry.path(), path());
  }
}

TEST_F(GoldenFile, DamagedDatabaseOfVersion1StaysAsItWas) {
  make("map_v1.sql");
  execute("UPDATE local_map SET blob = zeroblob(length(blob)) WHERE id = 2");
  EXPECT_THAT(error_of([&] { MapDatabase::open_existing(path()); }),
              HasSubstr("local_map 2 is damaged (its hash is wrong)"));
  execute("SELECT count(*) FROM local_map");  // still there
}

// It has no numbers of rooms yet, and accepts them afterwards.
TEST_F(GoldenFile, DatabaseOfVersion2TakesNumbersOfRooms) {
  make("map_v2.sql");
  const std::string before = content(path());
  EXPECT_TRUE(read_map(path()).rooms.empty());
  EXPECT_EQ(content(path()), before) << "read alone, it stays as it is";
  const planning::RoomMemory rooms = numbered_rooms();
  MapDatabase::open_existing(path()).put_rooms(rooms);
  EXPECT_EQ(read_map(path()).rooms, rooms);
}

// It has no walls, openings and doors yet, and accepts them afterwards.
TEST_F(GoldenFile, DatabaseOfVersion3TakesDrawnLines) {
  make("map_v3.sql");
  const std::string before = content(path());
  MapDrawing drawing = read_map(path()).drawing;
  EXPECT_TRUE(drawing.lines.empty());
  EXPECT_EQ(drawing.version, 0U);
  EXPECT_EQ(content(path()), before) << "read alone, it stays as it is";
  drawing.lines = {{planning::LineKind::kDoor, {{1.0, 0.0}, {1.0, 0.75}}, "front door"}};
  drawing.version = 1;
  MapDatabase::open_existing(path()).put_drawing(drawing);
  const MapDrawing read = read_map(path()).drawing;
  EXPECT_EQ(read.lines, drawing.lines);
  EXPECT_EQ(read.version, 1U);
  EXPECT_EQ(read.places, drawing.places);
  EXPECT_TRUE(read.grid);
}

/// Content of the golden file of version 2.
MapDocument golden_document_2() {
  MapDocument expected = golden_document();
  for (topomap::LocalMap& map : expected.local_maps) {
    map.stop =
        map.id < 3 ? topomap::StopId{0xfedcba9876543210U, map.id} : topomap::StopId{7, map.id - 2};
    map.odometry_epoch = 12;
  }
  expected.map_id = map_id_of(expected.local_maps[0].stop.session);
  expected.edges = {{0, 1, {1.0, 0.5, 0.25}, Eigen::Matrix3d::Identity()}};
  expected.drawing.zones.push_back(
      {"ramp", {{0.0, 0.0}, {4.0, 0.0}, {4.0, 3.0}}, planning::ZoneKind::kSlow, 0.3});
  return expected;
}

TEST_F(GoldenFile, DatabaseOfVersion2IsRead) {
  make("map_v2.sql");
  const MapDocument expected = golden_document_2();
  EXPECT_EQ(map_file_bytes(read_map(path())), map_file_bytes(expected));
  const MapDatabase database = MapDatabase::open_existing(path());
  EXPECT_EQ(map_file_bytes(database.load()), map_file_bytes(expected));
  const auto waiting = database.stop({7, 3});
  ASSERT_TRUE(waiting);
  EXPECT_EQ(waiting->odometry_epoch, 12U);
  ASSERT_EQ(database.sessions().size(), 2U);
  EXPECT_TRUE(database.sessions()[0].is_over);
  EXPECT_EQ(database.sessions()[0].joined, 3U);
  EXPECT_EQ(database.sessions()[1].stops, 4U) << "stop 0 was dropped";
  EXPECT_FALSE(database.sessions()[1].is_over);
}

TEST_F(GoldenFile, DatabaseOfVersion3IsRead) {
  make("map_v3.sql");
  const std::string before = content(path());
  MapDocument expected = golden_document_2();
  expected.rooms = numbered_rooms();
  expected.refused_merges = {{{0xfedcba9876543210U, 1}, {7, 2}}};
  EXPECT_EQ(map_file_bytes(read_map(path())), map_file_bytes(expected));
  EXPECT_EQ(content(path()), before) << "read alone, it stays as it is";
  // The map can grow.
  MapDatabase database = MapDatabase::open_existing(path());
  EXPECT_EQ(map_file_bytes(database.load()), map_file_bytes(expected));
  planning::RoomMemory rooms = expected.rooms;
  rooms.rooms.push_back({5, 9, {}, "lab"});
  rooms.last = 5;
  database.put_rooms(rooms);
  EXPECT_EQ(MapDatabase::open_existing(path()).load().rooms, rooms);
}

}  // namespace
}  // namespace topogeo::storage
