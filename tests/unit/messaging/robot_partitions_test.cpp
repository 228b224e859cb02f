#include "robot_partitions.hpp"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fnmatch.h>
#include <gmock/gmock.h>

namespace topogeo::messaging {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

using Names = std::vector<std::string>;

/// The middleware's comparison of a writer's and a reader's partitions.
bool meet(const Names& a, const Names& b) {
  for (const std::string& one : a) {
    for (const std::string& other : b) {
      if (::fnmatch(one.c_str(), other.c_str(), FNM_NOESCAPE) == 0 ||
          ::fnmatch(other.c_str(), one.c_str(), FNM_NOESCAPE) == 0) {
        return true;
      }
    }
  }
  return false;
}

const Names kAnna = {"anna"};
const Names kBert = {"bert"};
const Names kEvery = {"*"};

TEST(RobotPartitions, HaveTheRobotsOfTheKeysBehindThem) {
  EXPECT_THAT(partitions_by_robot("floor", {"anna", "bert"}, kBert),
              ElementsAre("floor/anna", "floor/bert"));
  EXPECT_THAT(partitions_by_robot("floor", kEvery, kAnna),
              ElementsAre("floor/anna", "floor/*", "floor"));
}

TEST(RobotPartitions, MeetWhereTheKeysShareARobot) {
  const Names anna = partitions_by_robot("floor", kAnna, kAnna);
  EXPECT_TRUE(meet(anna, partitions_by_robot("floor", {"bert", "anna"}, kBert)));
  EXPECT_FALSE(meet(anna, partitions_by_robot("floor", kBert, kBert)));
  EXPECT_FALSE(meet(anna, partitions_by_robot("other floor", kAnna, kAnna)));
}

TEST(RobotPartitions, OfKeysForEveryRobotMeetThoseOfEachRobot) {
  const Names pool = partitions_by_robot("*", kEvery, {});
  const Names page = partitions_by_robot("floor", kEvery, kAnna);
  const Names anna = partitions_by_robot("floor", kAnna, kAnna);
  const Names worker_of_anna = partitions_by_robot("*", kAnna, {});
  const Names worker_of_bert = partitions_by_robot("*", kBert, {});
  EXPECT_TRUE(meet(pool, anna));
  EXPECT_TRUE(meet(pool, page));
  EXPECT_TRUE(meet(page, anna));
  EXPECT_TRUE(meet(page, partitions_by_robot("floor", kBert, kBert)));
  EXPECT_TRUE(meet(worker_of_anna, anna));
  EXPECT_TRUE(meet(worker_of_anna, page));
  EXPECT_FALSE(meet(worker_of_bert, anna));
}

// Older programs with older keys have no partitions by robot.
TEST(RobotPartitions, OfKeysForEveryRobotMeetPlainOnes) {
  const Names plain = {"floor"};
  EXPECT_TRUE(meet(plain, partitions_by_robot("floor", kEvery, kAnna)));
  EXPECT_FALSE(meet(plain, partitions_by_robot("other floor", kEvery, kAnna)));
  EXPECT_FALSE(meet(plain, partitions_by_robot("floor", kAnna, kAnna)));
}

TEST(RobotPartitions, RefuseARobotThatTheKeysDoNotName) {
  EXPECT_THAT(
      [] {
        partitions_by_robot("floor", {"anna", "bert"}, {"carl"});
      },
      ThrowsMessage<std::runtime_error>(
          HasSubstr("the keys are for 'anna', 'bert', not for 'carl'")));
}

TEST(RobotPartitions, ShowTheirRobot) {
  EXPECT_EQ(robot_of_partition("floor/anna"), "anna");
  EXPECT_EQ(robot_of_partition("east/floor/anna"), "anna");
  EXPECT_EQ(robot_of_partition("floor"), "*");
  EXPECT_EQ(partition_without_robot("east/floor/anna"), "east/floor");
  EXPECT_EQ(partition_without_robot("floor"), "floor");
}

class RobotsOfKeys : public testing::Test {
 protected:
  RobotsOfKeys() {
    std::string pattern = testing::TempDir() + "robots-XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
  }
  RobotsOfKeys(const RobotsOfKeys&) = delete;
  RobotsOfKeys& operator=(const RobotsOfKeys&) = delete;
  ~RobotsOfKeys() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& text) { std::ofstream(folder_ / "robots") << text; }

  std::filesystem::path folder_;
};

TEST_F(RobotsOfKeys, AreTheLinesOfTheirFile) {
  write("anna\nbert\n");
  EXPECT_THAT(robots_of_keys(folder_), ElementsAre("anna", "bert"));
  write("all\n");
  EXPECT_THAT(robots_of_keys(folder_), ElementsAre("*"));
}

TEST_F(RobotsOfKeys, AreAllForOlderKeys) {
  EXPECT_THAT(robots_of_keys(folder_), ElementsAre("*"));
}

TEST_F(RobotsOfKeys, AreNeverNone) {
  write("\n");
  EXPECT_THAT([&] { robots_of_keys(folder_); },
              ThrowsMessage<std::runtime_error>(
                  AllOf(HasSubstr((folder_ / "robots").string()), HasSubstr("expected a name"))));
}

}  // namespace
}  // namespace topogeo::messaging
