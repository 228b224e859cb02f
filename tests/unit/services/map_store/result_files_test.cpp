#include "map_store/result_files.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/map_file.hpp"

namespace topogeo::map_store {
namespace {

namespace fs = std::filesystem;
using testing::UnorderedElementsAre;

class Files : public testing::Test {
 protected:
  Files() {
    fs::remove_all(directory_);
    fs::create_directories(directory_);
  }
  ~Files() override { fs::remove_all(directory_); }

  fs::path directory_ = fs::path(testing::TempDir()) /
                        (std::string("topogeo_result_files_") +
                         testing::UnitTest::GetInstance()->current_test_info()->name());
  fs::path database_ = directory_ / "map.sqlite";
};

topomap::LocalMap first_map() {
  topomap::LocalMap map;
  map.robot_id = "robot";
  map.stop = {5, 0};
  map.points = {{1.0F, 2.0F}};
  return map;
}

TEST_F(Files, DatabaseOfAnEarlierRunIsReplaced) {
  const topomap::LocalMap stop = first_map();
  EXPECT_TRUE(last_database(database_, "robot", 1).put_stops({&stop, 1}).empty());
  set_aside_database(database_);
  const storage::MapDatabase fresh = last_database(database_, "other", 2);
  EXPECT_TRUE(fresh.sessions().empty());
  EXPECT_EQ(fresh.robot_id(), "other");
}

TEST_F(Files, DatabaseOfBeforeGoesOn) {
  const topomap::LocalMap stop = first_map();
  EXPECT_TRUE(last_database(database_, "robot", 1).put_stops({&stop, 1}).empty());
  EXPECT_EQ(last_database(database_, "robot", 1).sessions().size(), 1U);
  EXPECT_THROW(last_database(database_, "other", 1), service::BadInputError);
  EXPECT_FALSE(fs::exists(directory_ / "map.previous.sqlite"));
}

TEST_F(Files, DatabaseBeginsWithTheMapThatItExtends) {
  storage::MapDocument map;
  map.robot_id = "robot";
  map.local_maps = {first_map()};
  storage::MapDatabase database = last_database(database_, "robot", 1);
  begin_with(database, map);
  EXPECT_EQ(database.local_map_count(), 1U);
  topomap::LocalMap next = first_map();
  next.stop = {6, 0};
  EXPECT_TRUE(database.put_stops({&next, 1}).empty());
  begin_with(database, map);  // after a restart
  EXPECT_EQ(database.sessions().size(), 2U);
  map.local_maps[0].stop.session = 9;
  EXPECT_THROW(begin_with(database, map), service::BadInputError);
}

TEST_F(Files, EmptyFileIsNoDatabase) {
  std::ofstream(database_).close();
  set_aside_database(database_);
  EXPECT_EQ(last_database(database_, "robot", 1).local_map_count(), 0U);
}

TEST_F(Files, FileOfSomebodyElseIsLeftAlone) {
  const std::string text =
      "my precious notes, longer than the smallest database" + std::string(1000, '.');
  std::ofstream(database_) << text;
  EXPECT_THROW(set_aside_database(database_), service::BadInputError);
  std::ifstream in(database_);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), text);
}

TEST_F(Files, DirectoryInItsPlaceIsBadInput) {
  fs::create_directories(database_ / "inside");
  EXPECT_THROW(set_aside_database(database_), service::BadInputError);
  EXPECT_TRUE(fs::exists(database_ / "inside"));
}

TEST_F(Files, ResultsAreWholeAndNothingElseStays) {
  storage::MapDocument document;
  document.robot_id = "robot";
  document.local_maps = {first_map()};
  document.trajectory.stops = {{0, 0, {}, Eigen::Matrix3d::Zero()}};
  fs::create_directories(directory_ / ".unfinished" / "left over");
  write_results(directory_, document, "title");
  write_results(directory_, document, "title");  // replaces the first files
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(directory_)) {
    names.push_back(entry.path().filename());
  }
  EXPECT_THAT(names, UnorderedElementsAre("map.pb", "map.png", "map.svg", "odometry.tum",
                                          "trajectory.tum"));
  EXPECT_EQ(storage::read_map_file(directory_ / "map.pb").local_maps.size(), 1U);
}

}  // namespace
}  // namespace topogeo::map_store
