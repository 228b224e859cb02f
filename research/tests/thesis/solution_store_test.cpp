#include "topogeo/thesis/solution_store.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

RelativeSolution solution(double x_m, double fitness) {
  return {{x_m, 0.0, 0.0}, Eigen::Matrix3d::Identity(), fitness};
}

TEST(SolutionStore, KeepsTheFittestOfAPairInOrder) {
  SolutionStore store(2);
  store.put(3, 7, {solution(1.0, 0.2), solution(2.0, 0.9), solution(3.0, 0.5), solution(4.0, 0.5)});
  const auto kept = store.find(3, 7);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[0].T_earlier_later.x_m, 2.0);
  EXPECT_EQ(kept[1].T_earlier_later.x_m, 3.0);  // the earlier of two equally fit ones
  EXPECT_TRUE(store.find(7, 8).empty());
}

TEST(SolutionStore, PutReplacesAndForgets) {
  SolutionStore store;
  store.put(0, 1, {solution(1.0, 0.5)});
  store.put(0, 1, {solution(2.0, 0.1)});
  ASSERT_EQ(store.find(0, 1).size(), 1U);
  EXPECT_EQ(store.find(0, 1)[0].T_earlier_later.x_m, 2.0);
  store.put(0, 1, {});
  EXPECT_TRUE(store.find(0, 1).empty());
  EXPECT_EQ(store.pairs(), 0U);
}

TEST(SolutionStore, KnowsWhatALaterMapWasMatchedWith) {
  SolutionStore store;
  store.put(5, 9, {solution(1.0, 0.5)});
  store.put(2, 9, {solution(1.0, 0.5)});
  store.put(2, 8, {solution(1.0, 0.5)});
  store.put(0, 10, {solution(1.0, 0.5)});
  EXPECT_EQ(store.matched_with(9), (std::vector<std::uint32_t>{2, 5}));
  EXPECT_TRUE(store.matched_with(7).empty());
}

TEST(SolutionStore, RefusesWhatIsNoSolution) {
  EXPECT_THROW(SolutionStore(0), std::invalid_argument);
  SolutionStore store;
  EXPECT_THROW(store.put(2, 2, {solution(1.0, 0.5)}), std::invalid_argument);
  EXPECT_THROW(store.put(1, 2, {solution(1.0, 1.5)}), std::invalid_argument);
  EXPECT_THROW(store.put(1, 2, {solution(1.0, std::nan(""))}), std::invalid_argument);
  RelativeSolution without = solution(1.0, 0.5);
  without.covariance(1, 1) = 0.0;
  EXPECT_THROW(store.put(1, 2, {without}), std::invalid_argument);
  EXPECT_EQ(store.pairs(), 0U);
}

}  // namespace
}  // namespace topogeo::localization
