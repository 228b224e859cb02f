// Tasks that search in one map go to the worker that has searched in it, unless that delays them.
#include "topogeo/search_pool/reference_holders.hpp"

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "board_fixture.hpp"

namespace topogeo::search_pool {
namespace {

std::vector<MatchTask> tasks_in(const std::vector<std::uint64_t>& references,
                                std::uint64_t first_id = 100) {
  std::vector<MatchTask> result = tasks(references.size(), first_id);
  for (std::size_t i = 0; i < references.size(); ++i) result[i].reference_hash = references[i];
  return result;
}

class ReferenceHoldersTest : public ::testing::Test {
 protected:
  std::size_t choose(const std::string& worker, const std::vector<std::uint64_t>& references) {
    TaskBatch batch;
    batch.begin(tasks_in(references));
    return holders_.choose(worker, batch.fresh(), batch);
  }
  ReferenceHolders holders_;
};

TEST_F(ReferenceHoldersTest, FirstComesWhatTheWorkerHoldsThenWhatNobodyHolds) {
  EXPECT_EQ(choose("a", {1, 2, 3}), 0U) << "nobody holds anything";
  holders_.add("a", 2);
  holders_.add("b", 1);
  EXPECT_EQ(choose("a", {1, 3, 2}), 2U) << "its own";
  EXPECT_EQ(choose("a", {1, 3, 4}), 1U) << "nobody's";
  EXPECT_EQ(choose("a", {1, 1}), 0U) << "the other's, as there is nothing else";
  EXPECT_EQ(choose("c", {1, 2, 3}), 2U) << "one that holds nothing";
}

TEST_F(ReferenceHoldersTest, SixteenAreHeldAndTheLatestStay) {
  for (std::uint64_t reference = 1; reference <= 16; ++reference) holders_.add("a", reference);
  holders_.add("a", 1);  // the latest now, as in the worker
  holders_.add("a", 17);
  EXPECT_EQ(choose("a", {2, 1}), 1U) << "2 was let go";
  EXPECT_EQ(choose("b", {1, 2}), 1U) << "so nobody holds it";
}

TEST_F(ReferenceHoldersTest, AWorkerThatHasGoneHoldsNothing) {
  holders_.add("a", 1);
  holders_.add("b", 1);
  holders_.add("b", 2);
  holders_.forget("b");
  EXPECT_EQ(choose("b", {1, 2}), 1U) << "2 is nobody's, 1 still another's";
  holders_.forget("a");
  EXPECT_EQ(choose("b", {1, 2}), 0U);
  holders_.forget("never known");
}

TEST_F(ReferenceHoldersTest, OnlyTheNextTasksOfALargeBatchAreLookedAt) {
  holders_.add("a", 1);
  std::vector<std::uint64_t> references(65, 2);
  holders_.add("b", 2);
  references[64] = 1;
  EXPECT_EQ(choose("a", references), 0U);
  references[63] = 1;
  EXPECT_EQ(choose("a", references), 63U);
}

/// A drive: each stop is matched with the three before it, by workers that always share the load.
TEST_F(TaskBoardTest, AMapIsSearchedByTheWorkerThatSearchedInItBefore) {
  constexpr std::uint64_t kStops = 40;
  up("a");
  up("b");
  std::map<std::uint64_t, std::set<std::string>> searched;  // by reference
  std::map<std::string, int> load;
  for (std::uint64_t stop = 3; stop < kStops; ++stop) {
    const auto step = tasks_in({stop - 1, stop - 2, stop - 3}, first_id_);
    board_.begin(step);
    for (const auto& [task, worker] : send_all(seconds(0))) {
      searched[step[task].reference_hash].insert(worker);
      ++load[worker];
      answer(worker, task, seconds(0));
    }
    expect_results(step.size());
    first_id_ += step.size();
  }
  std::size_t both = 0;
  for (const auto& [reference, workers] : searched) both += workers.size() - 1;
  EXPECT_LE(both, kStops / 4) << "maps that both have worked up";
  EXPECT_GE(load["a"], 2 * load["b"] / 3);
  EXPECT_GE(load["b"], load["a"] / 3);
}

}  // namespace
}  // namespace topogeo::search_pool
