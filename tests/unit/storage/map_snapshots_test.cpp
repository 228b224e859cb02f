// Snapshots of a map database, and the faults that taking and restoring one must survive.
#include "topogeo/storage/map_snapshots.hpp"

#include <array>
#include <csignal>

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "topogeo/storage/map_database.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/read_map.hpp"
#include "topogeo/support/format.hpp"

#include "sample_map.hpp"

namespace topogeo::storage {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class MapSnapshots : public ScratchDirectory {
 protected:
  [[nodiscard]] fs::path path() const { return directory_ / "map.sqlite"; }
  [[nodiscard]] fs::path folder() const { return directory_ / "map.snapshots"; }
  [[nodiscard]] MapDatabase open() const {
    return MapDatabase::open_or_create(path(), "robot-1", sample_document(0).seed);
  }
  /// Replaces the present map by one of so many stops.
  void begin(std::uint32_t stops) const {
    for (const char* suffix : {"", "-wal", "-shm"}) fs::remove(path().string() + suffix);
    open().put_document(sample_document(stops));
  }
  static std::string bytes(std::uint32_t stops) {
    return map_file_bytes(identified(sample_document(stops)));
  }
  static std::string bytes(const fs::path& file) { return map_file_bytes(read_map(file)); }

  /// Runs `work` in a process of its own; true when it ended by itself.
  template <typename Work>
  static bool in_child(const Work& work) {
    const pid_t child = ::fork();
    if (child == 0) {
      try {
        work();
      } catch (...) {
        ::_exit(1);
      }
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }
};

TEST_F(MapSnapshots, GiveBackTheMapOfTheirTime) {
  EXPECT_THAT(snapshots_of(path()), IsEmpty());
  begin(5);
  const MapSnapshot taken = take_snapshot(path(), "five");
  EXPECT_EQ(taken.path, folder() / "five.sqlite");
  EXPECT_EQ(taken.stops, 5U);
  EXPECT_EQ(taken.trajectory_version, 9U);
  EXPECT_EQ(taken.bytes, fs::file_size(taken.path));
  EXPECT_EQ(bytes(taken.path), bytes(5));
  begin(7);
  const auto former = restore_snapshot(path(), "five");
  ASSERT_TRUE(former);
  EXPECT_EQ(former->name, "before-five");
  EXPECT_EQ(bytes(former->path), bytes(7));
  EXPECT_EQ(bytes(path()), bytes(5));
  EXPECT_EQ(map_file_bytes(open().load()), bytes(5)) << "also for a map store";
  // Restores the former map; its name is taken.
  EXPECT_EQ(restore_snapshot(path(), "before-five")->name, "before-before-five");
  EXPECT_EQ(restore_snapshot(path(), "five")->name, "before-five-2");
  EXPECT_EQ(snapshots_of(path()).size(), 4U);
  EXPECT_EQ(bytes(path()), bytes(5));
}

TEST_F(MapSnapshots, AMapFromElsewhereBecomesOne) {
  begin(7);
  const MapSnapshot made = import_snapshot(path(), "merged", sample_document(5));
  EXPECT_EQ(made.stops, 5U);
  EXPECT_EQ(bytes(made.path), bytes(5));
  EXPECT_EQ(bytes(path()), bytes(7)) << "nothing else has changed";
  restore_snapshot(path(), "merged");
  EXPECT_EQ(bytes(path()), bytes(5));
  EXPECT_EQ(bytes(folder() / "before-merged.sqlite"), bytes(7));
  EXPECT_EQ(open().local_map_count(), 5U) << "the map store goes on with it";

  EXPECT_THAT(error_of([&] { import_snapshot(path(), "merged", sample_document(5)); }),
              HasSubstr("this snapshot exists already"));
  MapDocument foreign = sample_document(5);
  foreign.robot_id = "robot-2";
  EXPECT_THAT(error_of([&] { import_snapshot(path(), "foreign", foreign); }),
              HasSubstr("map of robot 'robot-2'"));
  MapDocument torn = sample_document(5);
  torn.loop_closures.push_back({99, 100, {}});
  EXPECT_THAT(error_of([&] { import_snapshot(path(), "torn", torn); }), HasSubstr("to be stored"));
  EXPECT_EQ(snapshots_of(path()).size(), 2U);
  EXPECT_FALSE(fs::exists(folder() / ".imported.sqlite"));
}

TEST_F(MapSnapshots, AreRenamedAndDeleted) {
  begin(5);
  const MapSnapshot taken = take_snapshot(path(), "five");
  static_cast<void>(take_snapshot(path(), "other"));
  rename_snapshot(path(), "five", "monday");
  EXPECT_FALSE(fs::exists(taken.path));
  EXPECT_EQ(bytes(folder() / "monday.sqlite"), bytes(5));
  EXPECT_THAT(error_of([&] { rename_snapshot(path(), "monday", "other"); }),
              HasSubstr("there is a snapshot other already"));
  EXPECT_THAT(error_of([&] { rename_snapshot(path(), "five", "six"); }),
              HasSubstr("there is no snapshot five"));
  EXPECT_THROW(rename_snapshot(path(), "monday", "../map"), std::invalid_argument);
  remove_snapshot(path(), "other");
  EXPECT_THAT(error_of([&] { remove_snapshot(path(), "other"); }),
              HasSubstr("there is no snapshot other"));
  EXPECT_THROW(remove_snapshot(path(), "../map"), std::invalid_argument);
  ASSERT_EQ(snapshots_of(path()).size(), 1U);
  EXPECT_EQ(snapshots_of(path()).front().name, "monday");
  EXPECT_EQ(bytes(path()), bytes(5)) << "the map itself stays";
}

TEST_F(MapSnapshots, RefuseNamesThatAreWrongOrTaken) {
  begin(2);
  take_snapshot(path(), "a");
  EXPECT_THAT(error_of([&] { take_snapshot(path(), "a"); }),
              HasSubstr("this snapshot exists already"));
  for (const char* name : {"", ".a", "a/b", "../a", "a b"}) {
    EXPECT_THAT(error_of([&] { take_snapshot(path(), name); }), HasSubstr("snapshot name")) << name;
  }
  EXPECT_THAT(error_of([&] { take_snapshot(path(), std::string(65, 'a')); }), HasSubstr("name"));
  EXPECT_THAT(error_of([&] { restore_snapshot(path(), "b"); }), HasSubstr("no such snapshot"));
  EXPECT_THAT(error_of([&] { take_snapshot(directory_ / "none.sqlite", "a"); }),
              HasSubstr("none.sqlite"));
  EXPECT_EQ(snapshots_of(path()).size(), 1U);
}

TEST_F(MapSnapshots, AreWholeWhileAnotherProgramWrites) {
  begin(3);
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const pid_t writer = ::fork();
  if (writer == 0) {
    MapDatabase database = open();
    MapDocument document = sample_document(3);
    for (std::uint64_t version = 10;; ++version) {  // all poses have one version
      for (topomap::StopPose& stop : document.trajectory.stops) {
        stop.T_map_robot.x_m = static_cast<double>(version);
      }
      database.put_trajectory(version, document.trajectory.stops, document.loop_closures);
      if (::write(ends[1], "x", 1) != 1) ::_exit(0);
    }
  }
  ::close(ends[1]);
  char byte = 0;
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(::read(ends[0], &byte, 1), 1);
    const MapDocument map = read_map(take_snapshot(path(), fmt::format("s{}", i)).path);
    for (const topomap::StopPose& stop : map.trajectory.stops) {
      EXPECT_EQ(stop.T_map_robot.x_m, static_cast<double>(map.trajectory.version));
    }
    EXPECT_GE(map.trajectory.version, 10U + static_cast<unsigned>(i));
    // The writer has it open: it must not be replaced meanwhile.
    EXPECT_THAT(error_of([&] { restore_snapshot(path(), "s0"); }), HasSubstr("has it open"));
  }
  ASSERT_EQ(::kill(writer, 0), 0) << "it goes on";
  ::close(ends[0]);
  ::kill(writer, SIGKILL);
  int status = 0;
  ::waitpid(writer, &status, 0);
  // The killed writer leaves a log.
  EXPECT_TRUE(fs::exists(path().string() + "-wal"));
  restore_snapshot(path(), "s0");
  EXPECT_EQ(bytes(path()), bytes(folder() / "s0.sqlite"));
}

TEST_F(MapSnapshots, RestoringThatIsKilledLeavesOneMapOrTheOther) {
  begin(5);
  take_snapshot(path(), "five");
  for (const char* step : {"former map kept", "restored"}) {
    begin(7);
    EXPECT_FALSE(in_child([&] {
      restore_snapshot(path(), "five", [&](std::string_view done) {
        if (done == step) ::kill(::getpid(), SIGKILL);
      });
    }));
    EXPECT_EQ(bytes(path()), bytes(step == std::string("restored") ? 5 : 7)) << step;
  }
  // Killed at any moment in between: each time a little later.
  int restored = 0;
  for (int delay_us = 0; restored < 3 && delay_us < 400'000; delay_us += 4000) {
    begin(7);
    const pid_t child = ::fork();
    if (child == 0) {
      restore_snapshot(path(), "five");
      ::_exit(0);
    }
    // Each child is killed at a different moment of its work.
    ::usleep(static_cast<useconds_t>(delay_us));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    const std::string found = map_file_bytes(open().load());
    EXPECT_TRUE(found == bytes(7) || found == bytes(5)) << delay_us;
    restored += WIFEXITED(status) ? 1 : 0;
  }
  for (const MapSnapshot& snapshot : snapshots_of(path())) EXPECT_EQ(snapshot.damage, "");
}

TEST_F(MapSnapshots, OnAFullDiskNothingIsLeftBehindAndNothingChanged) {
  begin(5);
  take_snapshot(path(), "five");
  begin(7);
  const auto files = [&] {
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(directory_)) {
      count += entry.is_regular_file() ? 1 : 0;
    }
    return count;
  };
  const std::size_t before = files();
  for (const bool restoring : {false, true}) {
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe(ends.data()), 0);
    in_child([&] {
      std::signal(SIGXFSZ, SIG_IGN);
      rlimit limit{};
      ::getrlimit(RLIMIT_FSIZE, &limit);
      limit.rlim_cur = fs::file_size(path()) / 2;
      ::setrlimit(RLIMIT_FSIZE, &limit);
      const std::string error = error_of([&] {
        restoring ? static_cast<void>(restore_snapshot(path(), "five"))
                  : static_cast<void>(take_snapshot(path(), "seven"));
      });
      if (::write(ends[1], error.data(), error.size()) < 0) ::_exit(1);
    });
    ::close(ends[1]);
    std::string error(4096, '\0');
    const ssize_t length = ::read(ends[0], error.data(), error.size());
    ::close(ends[0]);
    error.resize(length > 0 ? static_cast<std::size_t>(length) : 0);
    EXPECT_THAT(error, HasSubstr("cannot be read or written")) << restoring;
    EXPECT_EQ(files(), before) << restoring;
    EXPECT_EQ(bytes(path()), bytes(7)) << restoring;
  }
}

TEST_F(MapSnapshots, DamagedOnesAreListedAndNeverRestored) {
  begin(5);
  const MapSnapshot taken = take_snapshot(path(), "five");
  write(taken.path, content(taken.path).substr(0, taken.bytes / 2));
  ASSERT_EQ(snapshots_of(path()).size(), 1U);
  EXPECT_THAT(snapshots_of(path())[0].damage, HasSubstr("five.sqlite"));
  EXPECT_THAT(error_of([&] { restore_snapshot(path(), "five"); }), HasSubstr("five.sqlite"));
  EXPECT_EQ(bytes(path()), bytes(5));
  EXPECT_THAT(error_of([&] { take_snapshot(taken.path, "x"); }), HasSubstr("five.sqlite"));
}

TEST_F(MapSnapshots, TakeThePlaceOfADamagedMapWhichIsKept) {
  begin(5);
  take_snapshot(path(), "five");
  const std::string sound = content(path());
  for (const std::string& damaged :
       {sound.substr(0, sound.size() / 2), std::string(5000, 'x'),
        sound.substr(0, 4096) + std::string(sound.size() - 4096, 'x')}) {
    write(path(), damaged);
    const auto former = restore_snapshot(path(), "five");
    ASSERT_TRUE(former);
    EXPECT_NE(former->damage, "");
    // Except for the page with the format of the file.
    const std::string kept = content(former->path);
    EXPECT_EQ(kept.size(), damaged.size());
    EXPECT_TRUE(kept.substr(4096) == damaged.substr(4096));
    EXPECT_EQ(map_file_bytes(open().load()), bytes(5));
  }
  fs::remove(path());
  EXPECT_FALSE(restore_snapshot(path(), "five")) << "there was none";
  EXPECT_EQ(bytes(path()), bytes(5));
}

}  // namespace
}  // namespace topogeo::storage
