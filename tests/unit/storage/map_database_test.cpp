#include "topogeo/storage/map_database.hpp"

#include <csignal>

#include <gmock/gmock.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/read_map.hpp"
#include "topogeo/storage/report.hpp"

#include "sample_map.hpp"

namespace topogeo::storage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class MapDatabaseFile : public ScratchDirectory {
 protected:
  [[nodiscard]] std::filesystem::path path() const { return directory_ / "map.db"; }
  [[nodiscard]] MapDatabase open() const {
    return MapDatabase::open_or_create(path(), "robot-1", kSeed);
  }
  [[nodiscard]] std::string opening_error() const {
    return error_of([&] { static_cast<void>(open().load()); });
  }
  /// Writes a whole document and closes the database, which empties the write-ahead log.
  void store(const MapDocument& document) const { open().put_document(document); }
  void execute(const char* sql) const {
    sqlite3* handle = nullptr;
    ASSERT_EQ(sqlite3_open(path().c_str(), &handle), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(handle, sql, nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(handle);
    sqlite3_close(handle);
  }

  static constexpr std::uint64_t kSeed = 0xfedcba9876543210ULL;
};

TEST_F(MapDatabaseFile, GivesBackTheSameMapFile) {
  const MapDocument document = identified(sample_document(5));
  store(document);
  EXPECT_EQ(map_file_bytes(open().load()), map_file_bytes(document));
  EXPECT_EQ(map_file_bytes(MapDatabase::open_existing(path()).load()), map_file_bytes(document));
  EXPECT_EQ(map_file_bytes(read_map(path())), map_file_bytes(document));
  std::string in_pieces;
  open().write_map_file([&](std::string_view bytes) { in_pieces += bytes; });
  EXPECT_EQ(in_pieces, map_file_bytes(document));
}

TEST_F(MapDatabaseFile, KeepsRefusedMerges) {
  MapDocument document = identified(sample_document(2));
  document.refused_merges = {{{0xfedcba9876543210ULL, 7}, {3, 4000000000U}}};
  store(document);
  EXPECT_EQ(open().load().refused_merges, document.refused_merges);
  document.refused_merges.push_back({{1, 2}, {3, 4}});
  open().put_refused_merges(document.refused_merges);
  EXPECT_EQ(read_map(path()).refused_merges, document.refused_merges);
  EXPECT_EQ(parse_map_file(map_file_bytes(document), "file").refused_merges,
            document.refused_merges);
  execute("UPDATE meta SET value = '12 seven' WHERE key = 'refused_merges'");
  EXPECT_THAT(opening_error(), HasSubstr("refused_merges is no list of pairs of stops"));
}

LoopVerdict sample_verdict(std::uint32_t earlier, std::uint32_t later) {
  LoopVerdict verdict;
  verdict.step = later;
  verdict.earlier_id = earlier;
  verdict.later_id = later;
  verdict.explanation = "match not accepted: few inliers";
  verdict.source = "place";
  verdict.T_earlier_later = {0.1, -0.2, 0.3};
  verdict.T_predicted = {0.4, 0.5, -0.6};
  verdict.predicted_covariance << 1.0, 0.1, 0.2, 0.1, 2.0, 0.3, 0.2, 0.3, 3.0;
  verdict.correction_m = 0.7;
  verdict.correction_rad = -0.8;
  verdict.fitness = 0.25;
  verdict.probability = 0.5;
  return verdict;
}

TEST_F(MapDatabaseFile, KeepsTheEvidenceOfLoops) {
  MapDocument document = identified(sample_document(4));
  document.loop_verdicts = {sample_verdict(0, 2), sample_verdict(1, 3)};
  store(document);
  EXPECT_EQ(open().load().loop_verdicts, document.loop_verdicts);
  EXPECT_EQ(open().loop_verdicts(), document.loop_verdicts);
  EXPECT_EQ(parse_map_file(map_file_bytes(document), "file").loop_verdicts, document.loop_verdicts);
  document.loop_verdicts.front().outcome = LoopVerdict::Outcome::kOutvoted;
  document.loop_verdicts.pop_back();
  open().put_loop_verdicts(document.loop_verdicts);
  EXPECT_EQ(read_map(path()).loop_verdicts, document.loop_verdicts);
  EXPECT_THROW(open().put_loop_verdicts({sample_verdict(1, 4)}), std::invalid_argument);
  document.loop_verdicts.front().later_id = 4;
  EXPECT_THROW(map_file_bytes(document), std::invalid_argument);
  execute("UPDATE loop_verdict SET blob = x'00'");
  EXPECT_THAT(opening_error(), HasSubstr("loop_verdict 0 is damaged"));
}

TEST_F(MapDatabaseFile, HasNoEvidenceOfStopsWithOtherNumbers) {
  MapDocument document = identified(sample_document(4));
  document.loop_verdicts = {sample_verdict(0, 2)};
  store(document);
  topomap::Trajectory fewer = document.trajectory;
  fewer.stops.resize(2);
  ++fewer.version;
  fewer.numbered_since = fewer.version;
  open().renew(fewer, {},
               std::vector<JoinedStop>{{document.local_maps[0].stop, false},
                                       {document.local_maps[1].stop, false}});
  EXPECT_THAT(open().loop_verdicts(), IsEmpty());
}

TEST_F(MapDatabaseFile, TakesTheEvidenceOfAMapFileFromTheReportBesideIt) {
  MapDocument document = identified(sample_document(4));
  const LoopVerdict rejected = sample_verdict(0, 3);
  Report report;
  for (const topomap::LoopClosure& loop : document.loop_closures) {
    LoopCandidate accepted;
    accepted.step = accepted.later_id = loop.later_id;
    accepted.earlier_id = loop.earlier_id;
    accepted.outcome = accepted.reason = "accepted";
    accepted.T_earlier_later = loop.T_earlier_later;
    report.loop_candidates.push_back(accepted);
  }
  LoopCandidate candidate;
  candidate.step = candidate.later_id = 3;
  candidate.outcome = "match not accepted";
  candidate.reason = "few inliers";
  candidate.T_earlier_later = rejected.T_earlier_later;
  candidate.fitness = 0.25;
  candidate.source = "place";
  report.loop_candidates.push_back(candidate);
  write_report(directory_ / "report.json", report);
  MapDocument explained = document;
  add_verdicts_of_report(explained, directory_ / "map.pb");
  ASSERT_EQ(explained.loop_verdicts.size(), document.loop_closures.size() + 1);
  EXPECT_EQ(explained.loop_verdicts.front().outcome, LoopVerdict::Outcome::kAccepted);
  EXPECT_EQ(explained.loop_verdicts.back().explanation, rejected.explanation);
  EXPECT_EQ(explained.loop_verdicts.back().fitness, 0.25);

  report.loop_candidates.erase(report.loop_candidates.begin());
  write_report(directory_ / "report.json", report);
  MapDocument other = document;
  add_verdicts_of_report(other, directory_ / "map.pb");
  EXPECT_THAT(other.loop_verdicts, IsEmpty()) << "a loop of the map is not in that report";
}

TEST_F(MapDatabaseFile, KeepsTheNumbersOfRooms) {
  MapDocument document = identified(sample_document(2));
  const topomap::StopId stop{0xfedcba9876543210ULL, 7};
  document.rooms.rooms = {{1, 300, {{stop, {1.0, -0.5}}, {std::nullopt, {4.0, 2.0}}}, "kitchen"},
                          {4, 12, {}, ""}};
  document.rooms.places = {{{"kitchen", {3.0, 1.0}, 0.5}, 1, {stop, {0.25, 0.0}}, -1.5}};
  document.rooms.last = 5;
  store(document);
  EXPECT_EQ(open().load().rooms, document.rooms);
  document.rooms.rooms.erase(document.rooms.rooms.begin());
  document.rooms.places.clear();
  document.rooms.last = 6;
  open().put_rooms(document.rooms);
  EXPECT_EQ(read_map(path()).rooms, document.rooms);
  EXPECT_EQ(parse_map_file(map_file_bytes(document), "file").rooms, document.rooms);
}

TEST_F(MapDatabaseFile, RefusesNumbersOfRoomsThatCannotBe) {
  store(identified(sample_document(2)));
  MapDatabase database = open();
  planning::RoomMemory rooms{{{2, 1, {}, ""}}, {}, 2};
  database.put_rooms(rooms);
  const auto refusal = [&](const planning::RoomMemory& bad) {
    return error_of([&] { database.put_rooms(bad); });
  };
  EXPECT_THAT(refusal({{{3, 1, {}, ""}}, {}, 2}), HasSubstr("room 3 after 0"));
  EXPECT_THAT(refusal({{{0, 1, {}, ""}}, {}, 2}), HasSubstr("room 0 after 0"));
  EXPECT_THAT(refusal({{{2, 1, {}, ""}, {2, 1, {}, ""}}, {}, 2}), HasSubstr("room 2 after 2"));
  EXPECT_THAT(refusal({{}, {{{"a", {0.0, 0.0}}, 3, {}, 0.0}}, 2}),
              HasSubstr("place 'a' in room 3"));
  EXPECT_EQ(database.load().rooms, rooms);
}

TEST_F(MapDatabaseFile, GrowsAndChangesWithTheMap) {
  MapDocument document = identified(sample_document(3));
  store(document);
  MapDatabase database = open();
  EXPECT_EQ(database.local_map_count(), 3U);
  EXPECT_EQ(database.trajectory_version(), 9U);

  document.local_maps.push_back(sample_local_map(3));
  document.local_maps[3].stop = {document.local_maps[0].stop.session, 3};
  const std::vector<topomap::LocalMap> stops{document.local_maps[3], document.local_maps[1]};
  EXPECT_THAT(database.put_stops(stops), IsEmpty()) << "the second is there already";
  const JoinedStop joined{document.local_maps[3].stop, false};
  database.join({&joined, 1});
  document.trajectory.stops[1] = sample_stop(1, 77.0);
  document.trajectory.stops.push_back(sample_stop(3, 3.0));
  document.loop_closures = {{0, 3, {1.0, 2.0, 3.0}}};
  document.trajectory.version = 10;
  const std::vector<topomap::StopPose> changed{document.trajectory.stops[3],
                                               document.trajectory.stops[1]};
  database.put_trajectory(10, changed, document.loop_closures);
  document.global_map.nodes = {{3, topomap::NodeKind::kReal, {0.0, 0.0}, 1.0, 1},
                               {7, topomap::NodeKind::kReal, {5.0, 6.5}, 0.7, 2}};
  document.global_map.branches = {{5, 3, 7, true, 1, {{{0.0, 0.0}, 1.0}, {{5.0, 6.5}, 0.7}}}};
  document.global_map.version = 10;
  database.put_global_map(document.global_map);

  EXPECT_EQ(map_file_bytes(database.load()), map_file_bytes(document));
  EXPECT_EQ(map_file_bytes(open().load()), map_file_bytes(document));  // while it is open elsewhere
}

TEST_F(MapDatabaseFile, RefusesWhatDoesNotFitAndStaysAsItWas) {
  const MapDocument document = identified(sample_document(3));
  store(document);
  MapDatabase database = open();
  topomap::LocalMap other = document.local_maps[1];
  other.stamp_ns += 1;
  EXPECT_THAT(database.put_stops({&other, 1}), ElementsAre(document.local_maps[1].stop));
  JoinedStop joined{document.local_maps[1].stop, false};
  EXPECT_THAT(error_of([&] { database.join({&joined, 1}); }), HasSubstr("it is not stored, or"));
  joined.stop.number = 3;
  EXPECT_THROW(database.join({&joined, 1}), std::invalid_argument);
  other = sample_local_map(3);
  EXPECT_THROW(database.put_stops({&other, 1}), std::invalid_argument) << "it has no session";
  other.stop = {7, 3};
  other.robot_id = "";
  EXPECT_THROW(database.put_stops({&other, 1}), std::invalid_argument);
  EXPECT_THROW(database.put_document(document), std::invalid_argument) << "it has stops";

  const std::vector<topomap::StopPose> stops{sample_stop(0, 55.0), sample_stop(3, 0.0)};
  EXPECT_THAT(error_of([&] { database.put_trajectory(10, stops, {}); }),
              HasSubstr("stop 3 has no local map yet"));
  EXPECT_THROW(database.put_trajectory(8, {}, {}), std::invalid_argument);
  const std::vector<topomap::LoopClosure> closures{{1, 3, {}}};
  EXPECT_THROW(database.put_trajectory(10, {}, closures), std::invalid_argument);
  topomap::GlobalMap global = sample_global_map();
  global.branches[0].node_a = 99;
  EXPECT_THROW(database.put_global_map(global), std::invalid_argument);

  EXPECT_EQ(map_file_bytes(database.load()), map_file_bytes(document));
}

TEST_F(MapDatabaseFile, StopsLeaveTheMapForGood) {
  const MapDocument document = identified(sample_document(5));
  store(document);
  MapDatabase database = open();
  topomap::LocalMap late = sample_local_map(5);
  late.stop = {document.local_maps[0].stop.session, 5};
  database.put_stops({&late, 1});

  topomap::Trajectory trajectory;
  trajectory.version = trajectory.numbered_since = 12;
  std::vector<JoinedStop> kept;
  for (const std::uint32_t stop : {0U, 2U, 4U}) {
    trajectory.stops.push_back(document.trajectory.stops[stop]);
    trajectory.stops.back().local_map_id = static_cast<std::uint32_t>(kept.size());
    trajectory.stops.back().views = 7;
    trajectory.stops.back().last_view_ns = 99;
    kept.push_back({document.local_maps[stop].stop, stop > 0});
  }
  kept.push_back({{late.stop.session, 77}, false});
  const std::vector<topomap::LoopClosure> closures{{0, 2, {}}};
  EXPECT_THROW(database.renew(trajectory, closures, kept), std::invalid_argument);
  EXPECT_EQ(map_file_bytes(database.load()), map_file_bytes(document)) << "as it was";
  kept.pop_back();
  database.renew(trajectory, closures, kept);

  const auto expect_renewed = [&](const MapDatabase& renewed) {
    const MapDocument after = renewed.load();
    ASSERT_EQ(after.local_maps.size(), 3U);
    EXPECT_EQ(after.local_maps[1].stop.number, 2U);
    EXPECT_EQ(after.local_maps[1].id, 1U);
    EXPECT_TRUE(after.local_maps[1].starts_drive);
    EXPECT_EQ(after.trajectory.numbered_since, 12U);
    EXPECT_EQ(after.trajectory.stops[2].views, 7U);
    EXPECT_EQ(after.trajectory.stops[2].last_view_ns, 99);
    EXPECT_EQ(after.loop_closures.size(), 1U);
    EXPECT_TRUE(after.edges.empty());
    EXPECT_FALSE(renewed.stop(document.local_maps[1].stop));
    EXPECT_TRUE(renewed.knows(document.local_maps[1].stop)) << "it is not taken in again";
    EXPECT_THAT(renewed.waiting_stops(), ElementsAre(late.stop));
    ASSERT_EQ(renewed.sessions().size(), 1U);
    EXPECT_EQ(renewed.sessions()[0].stops, 6U);
    EXPECT_EQ(renewed.sessions()[0].joined, 3U);
  };
  expect_renewed(database);
  EXPECT_THAT(database.put_stops({&document.local_maps[1], 1}), IsEmpty());
  expect_renewed(database);
  expect_renewed(open());
}

TEST_F(MapDatabaseFile, RefusesAnotherRobotSeedVersionOrProgram) {
  store(sample_document(1));
  EXPECT_THAT(error_of([&] { MapDatabase::open_or_create(path(), "robot-2", kSeed); }),
              HasSubstr("map.db: holds the map of robot 'robot-1'"));
  EXPECT_THAT(error_of([&] { MapDatabase::open_or_create(path(), "robot-1", 3); }),
              HasSubstr("expected 'robot-1' with seed 3"));
  execute("PRAGMA user_version=5");
  EXPECT_THAT(opening_error(), HasSubstr("map database version 5, this program reads 1 to 4"));
  EXPECT_THAT(error_of([&] { read_map(path()); }), HasSubstr("map database version 5"));
  execute("PRAGMA user_version=4; PRAGMA application_id=5");
  EXPECT_THAT(opening_error(), HasSubstr("no topogeo map database"));
}

TEST_F(MapDatabaseFile, RefusesFilesThatAreNone) {
  EXPECT_THAT(error_of([&] { MapDatabase::open_existing(path()); }),
              HasSubstr("map.db: cannot be opened"));
  EXPECT_FALSE(std::filesystem::exists(path()));
  write(path(), "");
  EXPECT_THAT(error_of([&] { MapDatabase::open_existing(path()); }), HasSubstr("map.db: empty"));
  for (const std::string& bytes : {std::string("x"), std::string(5000, '\x7f')}) {
    write(path(), bytes);
    EXPECT_THAT(opening_error(), HasSubstr("map.db: ")) << bytes.size();
    EXPECT_TRUE(content(path()) == bytes) << "a foreign file was changed";
  }
  EXPECT_THAT(error_of([&] { MapDatabase::open_or_create(directory_, "robot-1", 1); }),
              HasSubstr("is a directory, expected a regular file"));
}

TEST_F(MapDatabaseFile, TakesAFileThatWasJustBegunForReplaceable) {
  std::ofstream(path(), std::ios::binary) << "no database, but long enough to be looked into";
  EXPECT_THROW(MapDatabase::check_replaceable(path()), std::runtime_error);
  std::filesystem::remove(path());
  // SQLite's first page, before there is any table.
  std::string page(4096, '\0');
  page.replace(0, 16, std::string("SQLite format 3\0", 16));
  page.replace(16, 8, std::string("\x10\x00\x02\x02\x00\x40\x20\x20", 8));
  page[27] = 1;
  page[31] = 1;
  page[100] = 0x0d;
  page[105] = 0x10;
  std::ofstream(path(), std::ios::binary) << page;
  EXPECT_NO_THROW(MapDatabase::check_replaceable(path()));
}

TEST_F(MapDatabaseFile, RefusesATruncatedFile) {
  store(sample_document(60));
  const std::string bytes = content(path());
  ASSERT_GT(bytes.size(), 20000U);
  for (std::size_t size = 1; size < bytes.size(); size += 1021) {
    write(path(), bytes.substr(0, size));
    EXPECT_THAT(opening_error(), HasSubstr("map.db: ")) << size;
    std::filesystem::remove(directory_ / "map.db-wal");
    std::filesystem::remove(directory_ / "map.db-shm");
  }
}

TEST_F(MapDatabaseFile, RefusesDamagedContent) {
  store(sample_document(3));
  const std::string good = content(path());
  for (const auto& [sql, message] : std::vector<std::pair<const char*, const char*>>{
           {"UPDATE stop SET blob = zeroblob(length(blob)) WHERE number = 1",
            "stop 1 is damaged (its hash is wrong)"},
           {"DELETE FROM stop WHERE number = 1", "is missing)"},
           {"DELETE FROM map_stop WHERE id = 1", "damaged (local map 2 is at index 1)"},
           {"DELETE FROM session", "a stop of a session that is not there"},
           {"UPDATE stop SET number = -1 WHERE number = 1", "damaged (stop number -1)"},
           {"DELETE FROM map_node WHERE id = 7", "ends at node 7, which does not exist"},
           {"UPDATE map_node SET blob = 'text'", "column blob has the wrong type"},
           {"UPDATE meta SET value = '12x' WHERE key = 'seed'", "seed is '12x'"},
           {"DELETE FROM meta WHERE key = 'robot_id'", "no 'robot_id'"}}) {
    write(path(), good);
    std::filesystem::remove(directory_ / "map.db-wal");
    std::filesystem::remove(directory_ / "map.db-shm");
    execute(sql);
    EXPECT_THAT(opening_error(), HasSubstr(message)) << sql;
  }
}

/// Writes stop after stop forever and reports each on `pipe` once it is stored.
[[noreturn]] void write_until_killed(const std::filesystem::path& path, std::uint64_t seed,
                                     int pipe) {
  try {
    MapDatabase database = MapDatabase::open_or_create(path, "robot-1", seed);
    for (std::uint32_t id = 0;; ++id) {
      const topomap::LocalMap stop = sample_stop_of(7, id);
      static_cast<void>(database.put_stops({&stop, 1}));
      const JoinedStop joined{stop.stop, false};
      database.join({&joined, 1});
      std::vector<topomap::StopPose> stops;
      for (std::uint32_t i = 0; i <= id; ++i) stops.push_back(sample_stop(i, i + 100.0 * id));
      database.put_trajectory(id, stops, {});
      topomap::GlobalMap map = sample_global_map();
      map.version = id;
      map.nodes[1].id = 10 + id;
      map.branches[0].node_b = 10 + id;
      database.put_global_map(map);
      if (::write(pipe, "x", 1) != 1) ::_exit(1);
    }
  } catch (const std::exception&) {
    ::_exit(2);
  }
}

TEST_F(MapDatabaseFile, KeepsAConsistentPrefixWhenItsProcessIsKilled) {
  for (const int acknowledged : {1, 2, 7, 30}) {
    std::filesystem::remove_all(directory_);
    std::filesystem::create_directory(directory_);
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) write_until_killed(path(), kSeed, ends[1]);
    ::close(ends[1]);
    char byte = 0;
    for (int i = 0; i < acknowledged; ++i) ASSERT_EQ(::read(ends[0], &byte, 1), 1);
    ::kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ::close(ends[0]);
    ASSERT_TRUE(WIFSIGNALED(status));

    MapDatabase database = open();
    const MapDocument document = database.load();  // checks ids, references and hashes
    ASSERT_GE(document.local_maps.size(), static_cast<std::size_t>(acknowledged));
    const std::uint64_t version = document.trajectory.version;
    ASSERT_GE(version + 1, static_cast<std::uint64_t>(acknowledged));
    // All poses have the same version.
    ASSERT_EQ(document.trajectory.stops.size(), version + 1);
    for (std::size_t i = 0; i < document.trajectory.stops.size(); ++i) {
      EXPECT_EQ(document.trajectory.stops[i].T_map_robot.x_m,
                static_cast<double>(i) + 100.0 * static_cast<double>(version));
    }
    ASSERT_EQ(document.global_map.nodes.size(), 2U);
    EXPECT_EQ(document.global_map.nodes[1].id, 10 + document.global_map.version);
    ASSERT_EQ(database.sessions().size(), 1U);
    const topomap::LocalMap next = sample_stop_of(7, database.sessions()[0].stops);
    EXPECT_THAT(database.put_stops({&next, 1}), IsEmpty()) << "it goes on";
    EXPECT_EQ(database.sessions()[0].stops, next.id + 1);
  }
}

}  // namespace
}  // namespace topogeo::storage
