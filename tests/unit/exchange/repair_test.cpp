#include "topogeo/exchange/repair.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/exchange/inspect.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/read_map.hpp"
#include "topogeo/support/random.hpp"

#include "readers.hpp"
#include "sample_floor.hpp"
#include "sample_stops.hpp"

namespace topogeo::exchange {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

storage::MapDocument whole_map() {
  storage::MapDocument document = sample_stops();
  document.global_map = sample_graph();
  document.global_map.version = 9;
  document.drawing = sample_drawing();
  document.drawing.grid = sample_space().grid();
  document.edges = {{0, 1, {1.0, 0.0, 0.0}, Eigen::Matrix3d::Identity()},
                    {1, 3, {2.0, 0.1, 0.0}, 2.0 * Eigen::Matrix3d::Identity()}};
  document.refused_merges = {{{0xfedcba9876543210U, 1}, {7, 3}}};
  document.rooms.rooms = {{1, 40, {{topomap::StopId{7, 2}, {1.0, -0.5}}}, "room A"},
                          {3, 12, {}, ""}};
  document.rooms.places = {{{"desk", {1.5, 2.0}}, 1, {topomap::StopId{7, 2}, {0.25, 0.0}}, 0.75}};
  document.rooms.last = 4;
  return document;
}

RepairedMap repaired(std::string_view bytes) {
  return assemble(pieces_of_map_file(bytes, "f"), {}, "f");
}

class Repair : public ScratchTest {};

TEST_F(Repair, AGoodFileComesBackByteForByte) {
  const std::string bytes = storage::map_file_bytes(whole_map());
  const RepairedMap map = repaired(bytes);
  EXPECT_THAT(map.lost, IsEmpty());
  EXPECT_EQ(storage::map_file_bytes(map.document), bytes);
}

TEST_F(Repair, OfAFileThatIsCutShortEverythingBeforeTheCutIsKept) {
  const storage::MapDocument whole = whole_map();
  const std::string bytes = storage::map_file_bytes(whole);
  std::size_t stops_before = 0;
  // The first local map ends before byte 2,000.
  for (std::size_t size = 2000; size < bytes.size(); size += 97) {
    const RepairedMap map = repaired(std::string_view(bytes).substr(0, size));
    EXPECT_THAT(map.lost, testing::Not(IsEmpty())) << size;
    const auto& maps = map.document.local_maps;
    EXPECT_GE(maps.size(), stops_before);
    stops_before = maps.size();
    for (std::size_t i = 0; i < maps.size(); ++i) {
      EXPECT_EQ(maps[i].points.size(), whole.local_maps[i].points.size());
    }
    // It can be written and read again without a fault.
    const std::string again = storage::map_file_bytes(map.document);
    EXPECT_THAT(contradictions(storage::parse_map_file(again, "again")), IsEmpty()) << size;
  }
  EXPECT_EQ(stops_before, whole.local_maps.size());
}

TEST_F(Repair, WithoutPosesTheyFollowFromScanTracking) {
  storage::MapDocument document = whole_map();
  document.trajectory.stops.clear();
  document.loop_closures.clear();
  const RepairedMap map = repaired(storage::map_file_bytes(document));
  const auto& stops = map.document.trajectory.stops;
  ASSERT_EQ(stops.size(), 6U);
  EXPECT_NEAR(stops[3].T_map_robot.x_m, 3.0, 1e-12);
  EXPECT_TRUE(stops[3].located);
  EXPECT_FALSE(stops[4].located);  // a later drive begins there
  EXPECT_THAT(map.lost, Contains("3 stops have poses by scan tracking alone"));
  EXPECT_THAT(map.lost, Contains("2 stops have no pose"));
}

TEST_F(Repair, ADamagedLocalMapCostsItselfAlone) {
  const storage::MapDocument whole = whole_map();
  std::string bytes = storage::map_file_bytes(whole);
  // The number of scan points of the third local map no longer fits its length.
  const std::string points(reinterpret_cast<const char*>(whole.local_maps[2].points.data()), 64);
  std::size_t at = 0;
  for (int i = 0; i < 3; ++i) at = bytes.find(points, at + 1);  // all see the same walls
  ASSERT_NE(at, std::string::npos);
  bytes[at - 1] = '\x7f';
  bytes[at - 2] = '\x7f';
  const RepairedMap map = repaired(bytes);
  ASSERT_EQ(map.document.local_maps.size(), 6U);
  EXPECT_TRUE(map.document.local_maps[2].points.empty());
  EXPECT_FALSE(map.document.local_maps[3].points.empty());
  EXPECT_EQ(map.document.trajectory.stops[2].T_map_robot, whole.trajectory.stops[2].T_map_robot);
  EXPECT_EQ(map.document.loop_closures.size(), 1U);
  EXPECT_EQ(map.document.global_map.branches.size(), whole.global_map.branches.size());
  EXPECT_THAT(map.lost, Contains("1 stops have no local map, the first is stop 2"));
}

TEST_F(Repair, WhereALengthIsDamagedReadingGoesOnBehind) {
  const storage::MapDocument whole = whole_map();
  std::string bytes = storage::map_file_bytes(whole);
  // A local map begins with the robot's name: tag, length in two bytes, name.
  std::size_t at = 0;
  for (int i = 0; i < 3; ++i) at = bytes.find("\x0a\x07robot-1", at + 1);
  bytes[at - 1] = '\x7f';
  const RepairedMap map = repaired(bytes);
  ASSERT_EQ(map.document.local_maps.size(), 6U);
  std::size_t without = 0;
  for (const topomap::LocalMap& local : map.document.local_maps) without += local.points.empty();
  EXPECT_EQ(without, 1U);
  EXPECT_EQ(map.document.trajectory.stops.size(), 6U);
  EXPECT_TRUE(map.document.drawing.grid);
}

TEST_F(Repair, MissingStopsKeepThePlaceInTheirSession) {
  storage::MapDocument whole = whole_map();
  for (topomap::LocalMap& map : whole.local_maps) map.stop = {0x77, map.id + 5};
  std::string bytes = storage::map_file_bytes(whole);
  for (const int lost : {1, 3}) {
    std::size_t at = 0;
    for (int i = 0; i < lost; ++i) at = bytes.find("\x0a\x07robot-1", at + 1);
    bytes[at - 1] = '\x7f';
  }
  const RepairedMap map = repaired(bytes);
  ASSERT_EQ(map.document.local_maps.size(), 6U);
  for (std::uint32_t id = 0; id < 6; ++id) {
    EXPECT_EQ(map.document.local_maps[id].stop, (topomap::StopId{0x77, id + 5}));
  }
  static_cast<void>(storage::map_file_bytes(map.document));
}

TEST_F(Repair, ADamagedNumberOfAStopMovesNoOther) {
  std::string bytes = storage::map_file_bytes(whole_map());
  std::size_t at = 0;
  for (int i = 0; i < 2; ++i) at = bytes.find("\x0a\x07robot-1\x10", at + 1);
  ASSERT_NE(at, std::string::npos);
  bytes[at + 10] = '\x05';  // the number after the robot's name was 2
  const RepairedMap map = repaired(bytes);
  ASSERT_EQ(map.document.local_maps.size(), 6U);
  EXPECT_EQ(map.document.local_maps[2].stamp_ns, 3'000'000'000);
}

TEST_F(Repair, ADigitThatIsDamagedIsTold) {
  std::string bytes = storage::map_file_bytes(whole_map());
  const std::string points(reinterpret_cast<const char*>(whole_map().local_maps[2].points.data()),
                           64);
  bytes[bytes.find(points) + 5] ^= 1;
  EXPECT_THAT(repaired(bytes).lost, Contains(HasSubstr("the checksum of the file is wrong")));
}

TEST_F(Repair, FlippedBitsNeverCostMoreThanTheyTouch) {
  const storage::MapDocument whole = whole_map();
  const std::string bytes = storage::map_file_bytes(whole);
  support::Random random(11);
  std::size_t saved = 0;
  constexpr int kFlips = 300;
  for (int i = 0; i < kFlips; ++i) {
    std::string bad = bytes;
    const std::size_t at = random.below(bytes.size());
    bad[at] = static_cast<char>(bad[at] ^ static_cast<char>(1 << random.below(8)));
    try {
      const RepairedMap map = repaired(bad);
      const std::string again = storage::map_file_bytes(map.document);
      static_cast<void>(storage::parse_map_file(again, "again"));
      std::size_t complete = 0;
      for (std::size_t k = 0; k < std::min<std::size_t>(6, map.document.local_maps.size()); ++k) {
        complete += map.document.local_maps[k].points.size() == whole.local_maps[k].points.size();
      }
      saved += complete >= 5;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), testing::StartsWith("f: "));
    }
  }
  EXPECT_GE(saved, static_cast<std::size_t>(kFlips) * 9 / 10);
}

TEST_F(Repair, ADamagedRoomCostsItselfAloneAndNoNumberIsGivenTwice) {
  StoredPieces pieces = pieces_of_map_file(storage::map_file_bytes(whole_map()), "f");
  ASSERT_EQ(pieces.rooms.size(), 2U);
  pieces.rooms.push_back(pieces.rooms[1]);  // a duplicate number
  pieces.rooms[0] = "\x08";
  pieces.last_room = 0;
  const RepairedMap map = assemble(pieces, {}, "f");
  EXPECT_THAT(map.lost, testing::ElementsAre("2 of 3 rooms cannot be read"));
  ASSERT_EQ(map.document.rooms.rooms.size(), 1U);
  EXPECT_EQ(map.document.rooms.rooms[0].number, 3U);
  EXPECT_EQ(map.document.rooms.last, 3U);
  EXPECT_EQ(map.document.rooms.places, whole_map().rooms.places);
}

TEST_F(Repair, WhatIsNoMapIsRefused) {
  EXPECT_EQ(error_of([] { repaired("hello"); }),
            "f: not a topogeo map (no 'topogeo-map' at its beginning)");
  EXPECT_EQ(error_of([] { repaired("\x0a\x0btopogeo-map"); }), "f: nothing can be recovered");
  EXPECT_THAT(error_of([&] { pieces_of_database(write("no.sqlite", "SQLite format 3")); }),
              HasSubstr("no.sqlite: nothing can be read"));
}

/// A database from the last program of a schema version, made with SQLite's own library.
void make_database(const std::filesystem::path& file, const std::string& golden) {
  const std::string script =
      "import sqlite3,sys; d=sqlite3.connect(sys.argv[1]); "
      "d.executescript(open(sys.argv[2]).read())";
  run_program({"/usr/bin/python3", "-c", script, file.string(),
               std::string(TOPOGEO_TEST_DATA) + "/" + golden});
}

TEST_F(Repair, ADatabaseKeepsNumbersOfRoomsAndRefusedMerges) {
  const std::filesystem::path file = directory_ / "map.sqlite";
  make_database(file, "map_v3.sql");
  const storage::MapDocument good = storage::read_map(file);
  ASSERT_FALSE(good.rooms.empty());
  ASSERT_FALSE(good.refused_merges.empty());
  const RepairedMap map = assemble(pieces_of_database(file), {}, "map.sqlite");
  EXPECT_THAT(map.lost, IsEmpty());
  EXPECT_EQ(map.document.rooms, good.rooms);
  EXPECT_EQ(map.document.refused_merges, good.refused_merges);
}

TEST_F(Repair, ADatabaseWithDamagedPagesGivesTheOthers) {
  const std::filesystem::path file = directory_ / "map.sqlite";
  make_database(file, "map_v1.sql");
  const storage::MapDocument good = storage::read_map(file);
  const RepairedMap map = assemble(pieces_of_database(file), {}, "map.sqlite");
  EXPECT_THAT(map.lost, IsEmpty());
  EXPECT_EQ(map.document.local_maps.size(), good.local_maps.size());
  EXPECT_EQ(map.document.loop_closures.size(), good.loop_closures.size());
  expect_same(map.document.global_map, good.global_map);
  // Each page is overwritten once.
  const std::string bytes = content(file);
  constexpr std::size_t kPage = 4096;
  std::size_t saved = 0;
  for (std::size_t at = kPage; at < bytes.size(); at += kPage) {
    std::string bad = bytes;
    bad.replace(at, kPage, kPage, '\x5a');
    const std::filesystem::path damaged = write("damaged.sqlite", bad);
    const std::string error = error_of([&] {
      const RepairedMap part = assemble(pieces_of_database(damaged), {}, "damaged.sqlite");
      static_cast<void>(storage::map_file_bytes(part.document));
      ++saved;
    });
    EXPECT_TRUE(error.empty() || error.find("damaged.sqlite") != std::string::npos) << error;
    EXPECT_EQ(content(damaged), bad);  // the file itself is unchanged
  }
  EXPECT_GE(saved, bytes.size() / kPage - 3);
}

}  // namespace
}  // namespace topogeo::exchange
