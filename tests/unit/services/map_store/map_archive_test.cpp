// Faults of a disk and of its users, each injected while a map arrives.
#include "map_store/map_archive.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/read_map.hpp"

#include "full_disk.hpp"
#include "services/common/random_values.hpp"

namespace topogeo::map_store {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint64_t kArchivedSession = 3;

class Archive : public testing::Test {
 protected:
  Archive() {
    fs::remove_all(directory_);
    fs::create_directories(directory_);
    archive_.emplace(storage::MapDatabase::open_or_create(path_, "robot", 1), path_);
    for (std::uint32_t i = 0; i < 300; ++i) {
      topomap::LocalMap map = any_local_map(random_);
      map.robot_id = "robot";
      map.id = i;
      map.stop = {kArchivedSession, i};
      map.starts_drive = false;
      maps_.push_back(std::move(map));
    }
  }
  ~Archive() override {
    archive_.reset();
    fs::remove_all(directory_);
  }

  void add(std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) archive_->add(maps_[i]);
  }
  [[nodiscard]] std::string flush_error() {
    try {
      static_cast<void>(archive_->flush());
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }
  /// Number of stops that another program finds in the file now.
  [[nodiscard]] std::uint32_t stored() const {
    const auto sessions = storage::MapDatabase::open_read_only(path_).sessions();
    return sessions.empty() ? 0 : sessions[0].stops;
  }

  support::Random random_{5};
  fs::path directory_ = fs::path(testing::TempDir()) /
                        (std::string("topogeo_archive_") +
                         testing::UnitTest::GetInstance()->current_test_info()->name());
  fs::path path_ = directory_ / "map.sqlite";
  std::optional<MapArchive> archive_;
  std::vector<topomap::LocalMap> maps_;
};

TEST_F(Archive, StoresWhatComesOnceAndInAnyOrder) {
  add(1, 100);
  EXPECT_TRUE(archive_->has_batch());
  EXPECT_THAT(archive_->flush(), IsEmpty());
  EXPECT_EQ(stored(), 0U) << "the first one is missing";
  add(0, 100);  // repeated
  EXPECT_EQ(archive_->queued(), 1U);
  EXPECT_THAT(archive_->flush(), IsEmpty());
  EXPECT_EQ(stored(), 100U);
}

TEST_F(Archive, StoresWhatTheTrajectoryNames) {
  add(0, 3);
  EXPECT_THAT(archive_->flush(), IsEmpty());
  std::vector<topomap::LocalMap> joined{maps_[0], topomap::numbered(maps_[2], 1, true)};
  topomap::Trajectory trajectory;
  trajectory.version = 4;
  for (std::uint32_t i = 0; i < 2; ++i) {
    trajectory.stops.push_back({i, joined[i].stamp_ns, {1.0 * i, 0.0, 0.0}, {}, joined[i].stop});
    trajectory.stops.back().covariance.setIdentity();
  }
  std::vector<topomap::LoopClosure> closures{{0, 1, {}}};
  archive_->put(joined, trajectory, closures);
  closures[0].T_earlier_later.x_m = 2.0;
  archive_->put(joined, trajectory, closures);
  const storage::MapDocument document = storage::read_map(path_);
  EXPECT_TRUE(document.local_maps == joined);
  EXPECT_EQ(document.trajectory.version, 4U);
  EXPECT_EQ(document.loop_closures[0].T_earlier_later.x_m, 2.0);
  EXPECT_THAT(archive_->database().waiting_stops(),
              ElementsAre(topomap::StopId{kArchivedSession, 1}));
}

// Segments of one trajectory arrive one by one: all have its version, and each brings poses.
TEST_F(Archive, StoresOtherPosesOfTheSameVersion) {
  add(0, 1);
  EXPECT_THAT(archive_->flush(), IsEmpty());
  const std::vector<topomap::LocalMap> joined{maps_[0]};
  topomap::Trajectory trajectory;
  trajectory.version = 4;
  trajectory.stops.push_back({0, maps_[0].stamp_ns, {}, {}, maps_[0].stop});
  trajectory.stops.back().covariance.setIdentity();
  archive_->put(joined, trajectory, {});
  trajectory.stops.back().T_map_robot.x_m = 1.0;
  archive_->put(joined, trajectory, {});
  EXPECT_EQ(storage::read_map(path_).trajectory.stops[0].T_map_robot.x_m, 1.0);
}

TEST_F(Archive, StopsThatLeaveTheMapLeaveTheFile) {
  add(0, 5);
  EXPECT_THAT(archive_->flush(), IsEmpty());
  topomap::Trajectory trajectory;
  trajectory.version = 4;
  std::vector<topomap::LocalMap> joined(maps_.begin(), maps_.begin() + 4);
  const auto poses_of = [&] {
    trajectory.stops.clear();
    for (const topomap::LocalMap& map : joined) {
      trajectory.stops.push_back({map.id, map.stamp_ns, {}, {}, map.stop});
      trajectory.stops.back().covariance.setIdentity();
    }
  };
  poses_of();
  archive_->put(joined, trajectory, {});
  joined = {maps_[0], topomap::numbered(maps_[3], 1, true), topomap::numbered(maps_[4], 2, false)};
  trajectory.version = trajectory.numbered_since = 5;
  poses_of();
  archive_->put(joined, trajectory, {});
  EXPECT_TRUE(storage::read_map(path_).local_maps == joined);
  EXPECT_FALSE(archive_->database().stop(maps_[1].stop));
  EXPECT_EQ(stored(), 5U);
  archive_->add(maps_[1]);
  EXPECT_EQ(archive_->queued(), 0U);
  // Poses are stored as usual afterwards.
  trajectory.version = 6;
  trajectory.stops[2].T_map_robot.x_m = 3.0;
  archive_->put(joined, trajectory, {});
  EXPECT_EQ(storage::read_map(path_).trajectory.stops[2].T_map_robot.x_m, 3.0);
}

TEST_F(Archive, KeepsTheNewestOfThoseThatNoMapWants) {
  topomap::LocalMap map = maps_[0];
  map.points.clear();
  const auto most = static_cast<std::uint32_t>(MapArchive::kMostWaiting + MapArchive::kBatch);
  for (std::uint32_t i = 0; i < most; ++i) {
    map.id = i;
    map.stop.number = i;
    archive_->add(map);
    if (archive_->has_batch()) {
      EXPECT_THAT(archive_->flush(), IsEmpty());
    }
  }
  EXPECT_EQ(archive_->database().waiting_count(), MapArchive::kMostWaiting);
  EXPECT_EQ(stored(), most) << "acknowledged for good";
  archive_->add(maps_[0]);
  EXPECT_EQ(archive_->queued(), 0U) << "a dropped one is not taken in again";
}

TEST_F(Archive, FullDisk) {
  add(0, 100);
  EXPECT_THAT(archive_->flush(), IsEmpty());
  add(100, 300);
  {
    const test::FullDisk full(fs::file_size(path_.string() + "-wal") + 20000);
    EXPECT_THAT(flush_error(), HasSubstr("map.sqlite: cannot be read or written"));
    EXPECT_EQ(stored(), archive_->database().sessions()[0].stops);
    EXPECT_GE(stored(), 100U);
    EXPECT_EQ(archive_->queued(), 300U - stored());
    EXPECT_THAT(flush_error(), HasSubstr("map.sqlite: ")) << "it is still full";
  }
  EXPECT_EQ(flush_error(), "") << "there is room again";
  EXPECT_EQ(stored(), 300U);
}

TEST_F(Archive, LockedFile) {
  add(0, 10);
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open(path_.c_str(), &other), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(other, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
  EXPECT_THAT(flush_error(), HasSubstr("database is locked"));
  EXPECT_EQ(archive_->queued(), 10U);
  ASSERT_EQ(sqlite3_exec(other, "ROLLBACK", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(other);
  EXPECT_EQ(flush_error(), "");
  EXPECT_EQ(stored(), 10U);
}

TEST_F(Archive, RemovedFileIsWrittenAgain) {
  add(0, 50);
  EXPECT_EQ(flush_error(), "");
  fs::remove(path_);
  add(50, 60);
  EXPECT_EQ(flush_error(), "");
  EXPECT_EQ(stored(), 60U);
  for (const char* part : {"", "-wal", "-shm"}) fs::remove(path_.string() + part);
  add(60, 70);
  EXPECT_EQ(flush_error(), "");
  add(70, 80);
  EXPECT_EQ(flush_error(), "");
  archive_.reset();
  EXPECT_EQ(stored(), 80U);
  EXPECT_EQ(storage::MapDatabase::open_existing(path_).waiting_count(), 80U);
}

TEST_F(Archive, RemovedFileOnAFullDiskStaysInMemory) {
  add(0, 50);
  EXPECT_EQ(flush_error(), "");
  fs::remove(path_);
  add(50, 60);
  {
    const test::FullDisk full(10000);
    EXPECT_THAT(flush_error(), HasSubstr("map.sqlite.again: "));
  }
  EXPECT_EQ(flush_error(), "");
  EXPECT_EQ(stored(), 60U);
}

TEST_F(Archive, AnotherFileInItsPlaceIsLeftAlone) {
  add(0, 5);
  EXPECT_EQ(flush_error(), "");
  fs::rename(path_, directory_ / "moved.sqlite");
  std::ofstream(path_) << "something else";
  add(5, 10);
  EXPECT_THAT(flush_error(), HasSubstr("another file has replaced the open database"));
  std::ifstream in(path_);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "something else");
  fs::remove(path_);
  EXPECT_EQ(flush_error(), "");
  EXPECT_EQ(stored(), 10U);
}

}  // namespace
}  // namespace topogeo::map_store
