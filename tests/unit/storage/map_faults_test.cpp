// Map databases after a power failure, and damaged copies of them.
#include <cstdlib>
#include <memory>

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include "topogeo/storage/map_database.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/read_map.hpp"
#include "topogeo/support/random.hpp"

#include "power_disk.hpp"
#include "sample_map.hpp"

namespace topogeo::storage {
namespace {

using ::testing::HasSubstr;

/// Number of injected faults. Injecting all of them takes minutes, so it is done only if the
/// environment variable is set.
int fault_count(int usual, int all) {
  return std::getenv("TOPOGEO_ALL_FAULTS") != nullptr ? all : usual;
}

class MapFaults : public ScratchDirectory {
 protected:
  [[nodiscard]] std::filesystem::path path() const { return directory_ / "map.sqlite"; }
  void forget_log() const {
    for (const char* part : {"-wal", "-shm"}) std::filesystem::remove(path().string() + part);
  }
};

/// A stop with a realistic number of scan points, so that the log grows past a checkpoint.
topomap::LocalMap full_stop(std::uint32_t number) {
  topomap::LocalMap map = sample_stop_of(7, number);
  for (int i = 0; i < 360; ++i) {
    map.points.push_back({static_cast<float>(number + 1) * 0.25F, static_cast<float>(i)});
  }
  return map;
}

struct Loss {
  PowerDisk::Files files;
  std::uint32_t acknowledged = 0;  // number of stops at the power failure
  std::uint64_t version = 0;       // of the trajectory
};

TEST_F(MapFaults, PowerLossLeavesAnEarlierStateWithAllThatWasAcknowledged) {
  support::Random random(3);
  const auto losses_wanted = static_cast<std::size_t>(fault_count(60, 400));
  std::vector<Loss> losses;
  std::uint32_t acknowledged = 0;
  std::uint64_t version = 0;
  PowerDisk* disk = nullptr;
  const auto maybe_lose = [&] {
    // About one write in thirty loses power, until there are enough losses.
    if (disk == nullptr || losses.size() >= losses_wanted || random.below(30) != 0) return;
    losses.push_back(
        {disk->after_power_loss(random, losses.size() % 2 == 1), acknowledged, version});
  };
  {
    PowerDisk running(maybe_lose);
    MapDatabase database = MapDatabase::open_or_create(path(), "robot-1", 1);
    disk = &running;
    while (losses.size() < losses_wanted) {
      std::vector<topomap::LocalMap> stops;
      std::vector<JoinedStop> joined;
      const std::uint64_t count = 1 + random.below(20);
      for (std::uint32_t i = 0; i < count; ++i) {
        stops.push_back(full_stop(acknowledged + i));
        joined.push_back({stops.back().stop, false});
      }
      ASSERT_TRUE(database.put_stops(stops).empty());
      acknowledged += static_cast<std::uint32_t>(stops.size());
      std::vector<topomap::StopPose> poses;
      for (std::uint32_t i = 0; i < acknowledged; ++i) {
        poses.push_back(sample_stop(i, static_cast<double>(version + 1)));
      }
      database.put_trajectory(version + 1, poses, {}, joined);
      ++version;
    }
    disk = nullptr;
  }
  for (const Loss& loss : losses) {
    std::filesystem::remove_all(directory_);
    std::filesystem::create_directory(directory_);
    for (const auto& [name, bytes] : loss.files) write(name, bytes);
    MapDatabase database = MapDatabase::open_existing(path());
    const MapDocument document = database.load();  // checks ids, references and hashes
    const std::uint32_t stops = database.sessions().empty() ? 0 : database.sessions()[0].stops;
    EXPECT_GE(stops, loss.acknowledged);
    EXPECT_GE(document.trajectory.version, loss.version);
    for (const topomap::StopPose& stop : document.trajectory.stops) {
      EXPECT_EQ(stop.T_map_robot.x_m, static_cast<double>(document.trajectory.version));
    }
    const topomap::LocalMap next = full_stop(stops);
    EXPECT_TRUE(database.put_stops({&next, 1}).empty()) << "it goes on";
  }
}

/// Opens and reads a copy as any program does. A damaged copy may look valid; otherwise the error
/// must name the file.
void expect_map_or_error(const std::filesystem::path& path, const std::string& before) {
  const std::string error = error_of([&] { static_cast<void>(read_map(path)); });
  if (!error.empty()) {
    EXPECT_THAT(error, HasSubstr(path.filename().string()));
  }
  std::ifstream in(path, std::ios::binary);
  EXPECT_TRUE(std::string(std::istreambuf_iterator<char>(in), {}) == before) << "it was changed";
  const std::string other = error_of([&] { MapDatabase::open_or_create(path, "robot-1", 5); });
  if (!other.empty()) {
    EXPECT_THAT(other, HasSubstr(path.filename().string()));
  }
}

TEST_F(MapFaults, DamagedCopiesAreReadOrRefusedByName) {
  MapDocument document = sample_document(40);
  document.drawing.zones = {{"hall", {{0.0, 0.0}, {4.0, 0.0}, {4.0, 3.0}}}};
  MapDatabase::open_or_create(path(), "robot-1", document.seed).put_document(document);
  const std::string good = content(path());
  const std::string good_file = map_file_bytes(identified(document));
  support::Random random(11);
  const auto position = [&](const std::string& bytes) { return random.below(bytes.size()); };
  for (int i = 0; i < fault_count(100, 1000); ++i) {
    std::string copy = good;
    if (i % 4 == 0) {
      copy.resize(position(copy));
    } else {
      for (int flips = 0; flips < i % 4; ++flips) {
        char& byte = copy[position(copy)];
        byte = static_cast<char>(byte ^ (1 << random.below(8)));
      }
    }
    forget_log();
    write(path(), copy);
    expect_map_or_error(path(), copy);
    // Every flipped bit of the exchange file is noticed.
    std::string file = good_file;
    char& byte = file[position(file)];
    byte = static_cast<char>(byte ^ (1 << random.below(8)));
    EXPECT_NE(error_of([&] { parse_map_file(file, "map.pb"); }), "");
  }
}

TEST_F(MapFaults, AFileThatMayNotBeWrittenIsRefusedAndCanBeRead) {
  const MapDocument document = identified(sample_document(3));
  MapDatabase::open_or_create(path(), "robot-1", document.seed).put_document(document);
  const std::string before = content(path());
  std::filesystem::permissions(path(), std::filesystem::perms(0444));
  std::filesystem::permissions(directory_, std::filesystem::perms(0555));
  // Root may write everything, so an unprivileged process tries.
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    constexpr uid_t kNobody = 65534;
    if (::geteuid() == 0 && ::seteuid(kNobody) != 0) ::_exit(3);
    const std::string error = error_of([&] {
      MapDatabase database = MapDatabase::open_existing(path());
      static_cast<void>(database.drop_waiting(0));
    });
    if (error.find("map.sqlite: ") == std::string::npos) ::_exit(1);
    const std::string reading =
        error_of([&] { static_cast<void>(map_file_bytes(read_map(path()))); });
    ::_exit(reading.empty() ? 0 : 2);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0) << "1: written, or an error without the name; 2: not read";
  std::filesystem::permissions(directory_, std::filesystem::perms(0755));
  EXPECT_TRUE(content(path()) == before);
}

// The numbering of a session continues for any order, gaps or losses.
TEST_F(MapFaults, SessionsAreCountedWithoutGaps) {
  MapDatabase database = MapDatabase::open_or_create(path(), "robot-1", 1);
  const auto put = [&](std::uint64_t session, std::uint32_t number) {
    const topomap::LocalMap map = sample_stop_of(session, number);
    EXPECT_TRUE(database.put_stops({&map, 1}).empty());
  };
  put(9, 1);
  put(9, 3);
  EXPECT_EQ(database.sessions()[0].stops, 0U);
  EXPECT_EQ(database.map_id(), map_id_of(9));
  put(9, 0);
  EXPECT_EQ(database.sessions()[0].stops, 2U);
  put(4, 0);
  put(9, 2);
  const std::vector<topomap::StopId> all{{9, 0}, {9, 1}, {9, 2}, {9, 3}, {4, 0}};
  EXPECT_EQ(database.waiting_stops(), all);
  EXPECT_EQ(database.drop_waiting(2), 3U);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(database.sessions()[0].stops, 4U);
    EXPECT_EQ(database.sessions()[0].first_kept, 3U);
    EXPECT_EQ(database.sessions()[1].stops, 1U);
    EXPECT_TRUE(database.knows({9, 1}));
    EXPECT_FALSE(database.stop({9, 1}));
    EXPECT_FALSE(database.knows({9, 4}));
    put(9, 1);  // too late
    EXPECT_EQ(database.waiting_count(), 2U);
    EXPECT_EQ(database.map_id(), map_id_of(9));
    database = MapDatabase::open_existing(path());
  }
  std::string bytes;
  EXPECT_EQ(database.write_local_maps(9, 2, [&](std::string_view piece) { bytes += piece; }), 1U);
  const auto maps = parse_local_maps(bytes, "answer");
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_EQ(maps[0].stop, (topomap::StopId{9, 3}));
  EXPECT_EQ(maps[0].odometry_epoch, 12U);
}

}  // namespace
}  // namespace topogeo::storage
