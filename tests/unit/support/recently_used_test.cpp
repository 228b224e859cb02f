#include "topogeo/support/recently_used.hpp"

#include <gtest/gtest.h>

namespace topogeo::support {
namespace {

TEST(RecentlyUsed, MakesAValueOnceAndForgetsTheOneThatWasNotUsedForLongest) {
  RecentlyUsed<int> cache(2);
  int made = 0;
  const auto get = [&](std::size_t key) {
    return cache.get(key, [&] {
      ++made;
      return static_cast<int>(10 * key);
    });
  };
  EXPECT_EQ(get(1), 10);
  EXPECT_EQ(get(2), 20);
  EXPECT_EQ(get(1), 10);
  EXPECT_EQ(made, 2);
  EXPECT_EQ(get(3), 30);  // 2 goes
  EXPECT_EQ(get(1), 10);
  EXPECT_EQ(made, 3);
  EXPECT_EQ(get(2), 20);
  EXPECT_EQ(made, 4);
}

}  // namespace
}  // namespace topogeo::support
