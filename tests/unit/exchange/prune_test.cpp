#include "topogeo/exchange/prune.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/storage/map_database.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/read_map.hpp"

#include "sample_stops.hpp"

namespace topogeo::exchange {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kDay_ns = 86'400'000'000'000;
constexpr std::uint64_t kGivenUp = 0x11;  // three days before the newest stop
constexpr std::uint64_t kYesterday = 0x22;
constexpr std::uint64_t kNewest = 0x33;

/// A map of one session, and pending stops of three others.
class PruneTest : public testing::Test {
 protected:
  PruneTest() {
    fs::remove_all(directory_);
    fs::create_directories(directory_);
    const storage::MapDocument map = storage::identified(sample_stops());
    storage::MapDatabase database =
        storage::MapDatabase::open_or_create(file_, map.robot_id, map.seed);
    database.put_document(map);
    for (const auto& [session, day] :
         {std::pair(kGivenUp, 7), std::pair(kYesterday, 9), std::pair(kNewest, 10)}) {
      for (std::uint32_t i = 0; i < 20; ++i) {
        topomap::LocalMap stop = map.local_maps[1];
        stop.id = i;
        stop.stop = {session, i};
        stop.stamp_ns = day * kDay_ns + i;
        stop.points.resize(1000);
        database.put_stops({&stop, 1});
      }
    }
  }
  ~PruneTest() override { fs::remove_all(directory_); }

  [[nodiscard]] std::vector<std::uint64_t> waiting() const {
    std::vector<std::uint64_t> sessions;
    for (const auto& stop : storage::MapDatabase::open_read_only(file_).waiting_stops()) {
      if (sessions.empty() || sessions.back() != stop.session) sessions.push_back(stop.session);
    }
    return sessions;
  }

  fs::path directory_ = fs::path(testing::TempDir()) / "topogeo_prune";
  fs::path file_ = directory_ / "map.sqlite";
};

TEST_F(PruneTest, DropsWhatNeverJoinedButNotTheNewestSession) {
  const std::string before = storage::map_file_bytes(storage::read_map(file_));
  const Pruned pruned = prune(file_, {}, {});
  ASSERT_EQ(pruned.sessions.size(), 2U);
  EXPECT_EQ(pruned.sessions[0].session, kGivenUp);
  EXPECT_EQ(pruned.sessions[0].stops, 20U);
  EXPECT_THAT(waiting(), testing::ElementsAre(kNewest));
  EXPECT_LT(pruned.bytes, pruned.bytes_before / 2);
  EXPECT_EQ(pruned.bytes, fs::file_size(file_));
  EXPECT_EQ(storage::map_file_bytes(storage::read_map(file_)), before);
  EXPECT_TRUE(storage::MapDatabase::open_read_only(file_).knows({kGivenUp, 3}))
      << "it is not taken in again";
}

TEST_F(PruneTest, LeavesWhatIsNotOldEnough) {
  const Pruned pruned = prune(file_, {.older_ns = 2 * kDay_ns, .times = {}}, {});
  ASSERT_EQ(pruned.sessions.size(), 1U);
  EXPECT_THAT(waiting(), testing::ElementsAre(kYesterday, kNewest));
}

TEST_F(PruneTest, ADryRunChangesNothing) {
  const Pruned pruned = prune(file_, {.times = 1, .dry_run = true}, {});
  EXPECT_EQ(pruned.sessions.size(), 2U);
  EXPECT_THAT(waiting(), testing::ElementsAre(kGivenUp, kYesterday, kNewest));
}

/// Ten drives along the same stops, a day apart.
TEST_F(PruneTest, DropsViewsThatOthersShow) {
  storage::MapDocument map = storage::identified(sample_stops());
  const std::size_t stops = map.local_maps.size();
  for (topomap::StopPose& stop : map.trajectory.stops) stop.located = true;
  map.trajectory.stops.resize(stops);
  for (std::uint64_t drive = 1; drive < 10; ++drive) {
    for (std::size_t i = 0; i < stops; ++i) {
      topomap::LocalMap again = map.local_maps[i];
      topomap::StopPose pose = map.trajectory.stops[i];
      again.id = pose.local_map_id = static_cast<std::uint32_t>(map.local_maps.size());
      again.stop = pose.stop = {100 + drive, static_cast<std::uint32_t>(i)};
      again.stamp_ns = pose.stamp_ns = static_cast<std::int64_t>(drive) * kDay_ns;
      again.starts_drive = i == 0;
      map.local_maps.push_back(again);
      map.trajectory.stops.push_back(pose);
    }
  }
  const storage::MapDocument fewer = with_fewer_views(map, 2, {});
  EXPECT_LT(fewer.local_maps.size(), map.local_maps.size());
  std::uint32_t views = 0;
  for (const topomap::StopPose& stop : fewer.trajectory.stops) views += stop.views;
  EXPECT_EQ(views, map.local_maps.size());
  EXPECT_EQ(fewer.trajectory.numbered_since, map.trajectory.version + 1);
  static_cast<void>(storage::parse_map_file(storage::map_file_bytes(fewer), "pruned"));

  fs::remove(file_);
  storage::MapDatabase::open_or_create(file_, map.robot_id, map.seed).put_document(map);
  const Pruned pruned = prune(file_, {.times = 2}, {});
  EXPECT_EQ(pruned.views, fewer.local_maps.size());
  EXPECT_EQ(storage::read_map(file_).local_maps.size(), fewer.local_maps.size());
}

}  // namespace
}  // namespace topogeo::exchange
