// A map store that is killed, stopped, restarted, or whose disk is full: the map survives.
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "topogeo/storage/map_database.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/read_map.hpp"
#include "topogeo/support/random.hpp"

#include "program.hpp"
#include "stored_drive.hpp"

namespace topogeo::test {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

class MapStoreLives : public testing::Test {
 protected:
  explicit MapStoreLives(const std::string& world = "room")
      : drive_(own_domain(), partition_, world) {}
  [[nodiscard]] std::vector<std::string> words(std::vector<std::string> more = {}) const {
    more.insert(more.end(), {"--out", (scratch_ / "out").string(), "--domain", own_domain(),
                             "--partition", partition_});
    return more;
  }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const {
    return scratch_ / "out" / name;
  }

  const bool udp_only_ = (use_udp_only(), true);
  std::string partition_ = "lives" + std::to_string(std::random_device{}());
  Scratch scratch_;
  StoredDrive drive_;
};

class MapStoreKilled : public MapStoreLives {
 protected:
  MapStoreKilled() : MapStoreLives("floor") {}  // enough stops for many lives
};

TEST_F(MapStoreKilled, AtAnyMomentItHasAllThatItAcknowledged) {
  support::Random random(std::random_device{}());
  const unsigned kills = std::getenv("TOPOGEO_ALL_FAULTS") != nullptr ? 200 : 6;
  for (unsigned kill = 0; kill < kills; ++kill) {
    Program store(scratch_, "map_store", words());
    // Kills it at any time up to the last message, also before it has started up.
    const auto lead = milliseconds(random.below(1500));
    const auto begin = std::chrono::steady_clock::now();
    std::uint32_t stops = std::max(1U, drive_.most_stored());
    // Each life gets its share of the drive.
    const auto most = static_cast<std::uint32_t>((kill + 1) * (drive_.stops() - 1) / kills);
    while (std::chrono::steady_clock::now() - begin < lead) {
      stops = std::max(std::min(stops + 1, most), drive_.most_stored());
      drive_.send(stops);
      drive_.run_for(milliseconds(random.below(20)));
    }
    store.send_signal(SIGKILL);
    ASSERT_EQ(store.wait(), 128 + SIGKILL) << store.err();
    drive_.run_for(milliseconds(20));  // acknowledgements in transit
    if (drive_.most_stored() == 0) continue;
    const auto database = storage::MapDatabase::open_read_only(file("map.sqlite"));
    ASSERT_EQ(database.sessions().size(), 1U);
    EXPECT_GE(database.sessions()[0].stops, drive_.most_stored());
    const storage::MapDocument document = database.load();  // checks everything
    for (std::uint32_t i = 0; i < drive_.most_stored(); ++i) {
      const auto stop = database.stop({drive_.map().local_maps[0].stop.session, i});
      ASSERT_TRUE(stop) << i;
      EXPECT_EQ(topomap::content_hash(*stop), topomap::content_hash(drive_.as_sent(i)));
    }
  }
  Program store(scratch_, "map_store", words());
  drive_.finish();
  store.wait_for_error_text("local maps, ");  // the final line
  EXPECT_TRUE(storage::map_file_bytes(drive_.map()) == read_file(file("map.pb")))
      << "another map than without interruptions";
}

TEST_F(MapStoreLives, StoppedItWritesTheMapAndGoesOnWithItLater) {
  {
    Program store(scratch_, "map_store", words());
    drive_.send(4);
    ASSERT_TRUE(drive_.wait_for_stored(4));
    store.send_signal(SIGTERM);
    EXPECT_EQ(store.wait(), 0) << store.err();
  }
  EXPECT_EQ(storage::read_map_file(file("map.pb")).trajectory.stops.size(), 4U);
  for (const char* name : {"trajectory.tum", "odometry.tum", "map.svg", "map.png"}) {
    EXPECT_TRUE(std::filesystem::exists(file(name))) << name;
  }
  const storage::MapDocument stored = storage::read_map(file("map.sqlite"));
  EXPECT_EQ(stored.trajectory.stops.size(), 4U);
  EXPECT_EQ(stored.map_id, drive_.map().map_id);
  {
    Program store(scratch_, "map_store", words());
    drive_.finish();
    store.wait_for_error_text("local maps, ");
    EXPECT_TRUE(storage::map_file_bytes(drive_.map()) == read_file(file("map.pb")));
    store.send_signal(SIGTERM);
    EXPECT_EQ(store.wait(), 0);
  }
  // A reader that writes nothing needs only the file.
  EXPECT_TRUE(storage::map_file_bytes(storage::read_map(file("map.sqlite"))) ==
              read_file(file("map.pb")));
  Program store(scratch_, "map_store", words({"--new"}));
  store.wait_for_error_text("local maps, ");  // it also receives the maps that were sent before
  EXPECT_EQ(storage::read_map(file("map.previous.sqlite")).local_maps.size(), drive_.stops());
}

TEST_F(MapStoreLives, EdgesThatComeBeforeTheirStopsAreStoredWithThem) {
  Program store(scratch_, "map_store", words());
  drive_.send(4);
  ASSERT_TRUE(drive_.wait_for_stored(4));
  drive_.send_edges();
  ASSERT_TRUE(drive_.wait_until("edges in the map file", [&] {
    return !storage::read_map(file("map.sqlite")).edges.empty();
  }));
  drive_.finish();
  store.wait_for_error_text("local maps, ");
  EXPECT_TRUE(storage::map_file_bytes(storage::read_map(file("map.sqlite"))) ==
              read_file(file("map.pb")));
}

TEST_F(MapStoreLives, ItAcknowledgesAndGivesTheMapToWhoAsks) {
  Program store(scratch_, "map_store", words());
  drive_.send(5);
  ASSERT_TRUE(drive_.wait_for_stored(5));
  const std::uint64_t session = drive_.map().local_maps[0].stop.session;
  const topomap::LocalMap last = drive_.as_sent(4);
  EXPECT_EQ(drive_.stored().map_id(), drive_.map().map_id);
  EXPECT_EQ(drive_.stored().session(), session);
  EXPECT_EQ(drive_.stored().stamp_ns(), last.stamp_ns);
  EXPECT_EQ(drive_.stored().content_hash(), topomap::content_hash(last));
  EXPECT_EQ(service::from_msg(drive_.stored().T_odom_robot()), last.T_odom_robot);

  const storage::MapDocument got =
      storage::parse_map_file(drive_.ask(msg::kSnapshotMap), "snapshot");
  EXPECT_EQ(got.map_id, drive_.map().map_id);
  ASSERT_EQ(got.local_maps.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_TRUE(got.local_maps[i].stop == drive_.as_sent(i).stop);
  EXPECT_EQ(got.trajectory.version, 5U);

  const auto since =
      storage::parse_local_maps(drive_.ask(msg::kSnapshotLocalMaps, session, 3), "snapshot");
  ASSERT_EQ(since.size(), 2U);
  EXPECT_EQ(since[1].stop, last.stop);
  EXPECT_EQ(drive_.ask(msg::kSnapshotLocalMaps, 12345, 0), "") << "no such session, no stops";
}

TEST_F(MapStoreLives, SnapshotsAreTakenWhileItWritesAndRestoredWhenItIsStopped) {
  const std::string out = (scratch_ / "out").string();
  const auto run_store_command = [&](const std::vector<std::string>& words) {
    Program command(scratch_, "topogeo", words);
    const int code = command.wait();
    return std::pair(code, command.out() + command.err());
  };
  {
    Program store(scratch_, "map_store", words());
    drive_.send(4);
    ASSERT_TRUE(drive_.wait_for_stored(4));
    const auto [taken, text] = run_store_command({"store", "snapshot", out, "four"});
    EXPECT_EQ(taken, 0) << text;
    EXPECT_THAT(text, HasSubstr("4 stops"));
    const auto [restored, why] = run_store_command({"store", "restore", out, "four"});
    EXPECT_EQ(restored, 1);
    EXPECT_THAT(why, HasSubstr("a map store or another program has it open"));
    drive_.send(drive_.stops() - 1);  // it continues
    ASSERT_TRUE(drive_.wait_for_stored(drive_.stops() - 1));
    store.send_signal(SIGTERM);
    EXPECT_EQ(store.wait(), 0) << store.err();
  }
  const auto [restored, text] = run_store_command({"store", "restore", out, "four"});
  EXPECT_EQ(restored, 0) << text;
  EXPECT_EQ(storage::read_map(file("map.sqlite")).local_maps.size(), 4U);
  const auto [listed, lines] = run_store_command({"store", "snapshots", out});
  EXPECT_EQ(listed, 0);
  EXPECT_THAT(lines, HasSubstr("before-four"));
  EXPECT_EQ(run_store_command({"store", "snapshot", out, "a/b"}).first, 2);
  EXPECT_EQ(run_store_command({"store", "snapshot", scratch_ / "none", "a"}).first, 3);
  // It continues with the map of that time; the senders still have the rest.
  Program store(scratch_, "map_store", words());
  drive_.finish();
  store.wait_for_error_text("local maps, ");
  EXPECT_TRUE(storage::map_file_bytes(drive_.map()) == read_file(file("map.pb")));
}

TEST_F(MapStoreLives, OnAFullDiskTheMapGoesOnInMemory) {
  Program store(scratch_, "map_store", words());
  drive_.send(3);
  ASSERT_TRUE(drive_.wait_for_stored(3));
  rlimit before{};
  ASSERT_EQ(::prlimit(store.pid(), RLIMIT_FSIZE, nullptr, &before), 0);
  rlimit full = before;
  full.rlim_cur = std::filesystem::file_size(file("map.sqlite-wal"));
  ASSERT_EQ(::prlimit(store.pid(), RLIMIT_FSIZE, &full, nullptr), 0);
  drive_.send(drive_.stops() - 1);
  store.wait_for_error_text("map.sqlite: cannot be read or written");
  EXPECT_LT(drive_.stored().session_stops(), drive_.stops() - 1);
  ASSERT_EQ(::prlimit(store.pid(), RLIMIT_FSIZE, &before, nullptr), 0);
  store.wait_for_error_text("storing the map works again");
  EXPECT_TRUE(drive_.wait_for_stored(drive_.stops() - 1));
  drive_.finish();
  store.wait_for_error_text("local maps, ");
  EXPECT_TRUE(storage::map_file_bytes(drive_.map()) == read_file(file("map.pb")));
}

/// Programs started meanwhile can make no file larger than this: a full disk.
class FullDiskForPrograms {
 public:
  explicit FullDiskForPrograms(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit full = before_;
    full.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &full);
  }
  FullDiskForPrograms(const FullDiskForPrograms&) = delete;
  FullDiskForPrograms& operator=(const FullDiskForPrograms&) = delete;
  ~FullDiskForPrograms() { ::setrlimit(RLIMIT_FSIZE, &before_); }

  [[nodiscard]] const rlimit& before() const { return before_; }

 private:
  rlimit before_{};
};

// Too small for the index of the database's log, large enough for the program's own log.
constexpr rlim_t kTooLittle_bytes = 16'000;

TEST_F(MapStoreLives, StartedOnAFullDiskItWaitsForRoom) {
  {
    Program store(scratch_, "map_store", words());
    drive_.send(4);
    ASSERT_TRUE(drive_.wait_for_stored(4));
    store.send_signal(SIGTERM);
    EXPECT_EQ(store.wait(), 0) << store.err();
  }
  rlimit before{};
  std::optional<Program> store;
  {
    const FullDiskForPrograms full(kTooLittle_bytes);
    before = full.before();
    store.emplace(scratch_, "map_store", words());
  }
  store->wait_for_error_text("disk full: ");
  // On a busy machine a command may give up before it has found the store.
  EXPECT_TRUE(wait_for("a status of the store", [&] {
    Program status(scratch_, "topogeo",
                   {"status", "--domain", own_domain(), "--partition", partition_});
    const int code = status.wait();
    return code != 0 && status.out().find("waiting for disk space") != std::string::npos;
  }));
  EXPECT_FALSE(store->ended());
  ASSERT_EQ(::prlimit(store->pid(), RLIMIT_FSIZE, &before, nullptr), 0);
  store->wait_for_error_text("disk space is available again");
  drive_.finish();
  store->wait_for_error_text("local maps, ");
  EXPECT_TRUE(storage::map_file_bytes(drive_.map()) == read_file(file("map.pb")));
}

TEST_F(MapStoreLives, OnAFullDiskANewMapLeavesTheLastOneWhole) {
  {
    Program store(scratch_, "map_store", words());
    drive_.send(4);
    ASSERT_TRUE(drive_.wait_for_stored(4));
    store.send_signal(SIGTERM);
    EXPECT_EQ(store.wait(), 0) << store.err();
  }
  std::optional<Program> store;
  {
    const FullDiskForPrograms full(kTooLittle_bytes);
    store.emplace(scratch_, "map_store", words({"--new"}));
  }
  store->wait_for_error_text("disk full: ");
  store->send_signal(SIGTERM);
  EXPECT_EQ(store->wait(), 0) << store->err();
  const bool moved = std::filesystem::exists(file("map.previous.sqlite"));
  EXPECT_EQ(storage::read_map(file(moved ? "map.previous.sqlite" : "map.sqlite")).local_maps.size(),
            4U);
}

TEST_F(MapStoreLives, ADamagedMapIsRefusedAndLeftAlone) {
  std::filesystem::create_directory(scratch_ / "out");
  const std::string damaged = std::string("SQLite format 3\0", 16) + std::string(5000, 'x');
  std::ofstream(file("map.sqlite"), std::ios::binary) << damaged;
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--new"}}) {
    Program store(scratch_, "map_store", words(more));
    EXPECT_EQ(store.wait(), 3);
    EXPECT_THAT(store.err(), HasSubstr("map.sqlite: "));
    EXPECT_TRUE(read_file(file("map.sqlite")) == damaged);
  }
}

}  // namespace
}  // namespace topogeo::test
