// Samples that arrive before the program takes them.
#include "arrivals.hpp"

#include <chrono>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::messaging::detail {
namespace {

using Numbers = std::vector<std::uint64_t>;

Handle handle(std::uint8_t number) {
  Handle result;
  result.bytes[0] = number;
  return result;
}

Arrival arrival(std::uint8_t writer, std::uint8_t instance, std::uint64_t number) {
  Arrival result;
  result.info.writer = handle(writer);
  result.info.instance = handle(instance);
  result.number = number;
  return result;
}

Numbers take_all(Arrivals& arrivals) {
  Numbers numbers;
  for (Arrival next; arrivals.take(next);) numbers.push_back(next.number);
  return numbers;
}

TEST(Arrivals, KeepTheNewestOfEachInstanceAndWriter) {
  Arrivals arrivals(1, 100);
  arrivals.put({arrival(1, 1, 10), arrival(1, 2, 11), arrival(2, 1, 50)});
  arrivals.put({arrival(1, 1, 12), arrival(2, 1, 51)});
  EXPECT_EQ(take_all(arrivals), (Numbers{11, 12, 51}));
}

TEST(Arrivals, KeepAsManyAsTheReaderDoes) {
  Arrivals arrivals(3, 100);
  for (std::uint64_t number = 1; number <= 5; ++number) arrivals.put({arrival(1, 1, number)});
  EXPECT_EQ(arrivals.size(), 3U);
  EXPECT_EQ(take_all(arrivals), (Numbers{3, 4, 5}));
}

// The middleware orders an instance's samples by their stamps, and clocks step.
TEST(Arrivals, OfOneWriterComeInTheOrderOfTheirNumbers) {
  Arrivals last(1, 100);
  last.put({arrival(1, 1, 2), arrival(1, 1, 1)});
  EXPECT_EQ(take_all(last), Numbers{2});
  Arrivals several(4, 100);
  several.put({arrival(1, 1, 3), arrival(1, 1, 1), arrival(1, 1, 2)});
  EXPECT_EQ(take_all(several), (Numbers{1, 2, 3}));
}

TEST(Arrivals, WhatDoesNotFitIsAnnouncedAgain) {
  Arrivals arrivals(1, 2);
  EXPECT_TRUE(arrivals.take_announced()) << "at the start";
  EXPECT_FALSE(arrivals.is_full(2));
  EXPECT_FALSE(arrivals.take_announced());
  arrivals.put({arrival(1, 1, 1), arrival(1, 2, 2)});
  EXPECT_TRUE(arrivals.is_full(1));
  EXPECT_TRUE(arrivals.take_announced());
  EXPECT_FALSE(arrivals.take_announced());
  EXPECT_EQ(take_all(arrivals).size(), 2U);
  EXPECT_FALSE(arrivals.is_full(1));
}

TEST(Arrivals, AreWaitedForHereAndInTheMiddleware) {
  Arrivals arrivals(1, 100);
  EXPECT_TRUE(arrivals.take_announced());
  EXPECT_FALSE(arrivals.wait(std::chrono::nanoseconds(1)));
  arrivals.put({arrival(1, 1, 1)});
  EXPECT_TRUE(arrivals.wait(std::chrono::nanoseconds(1)));
  EXPECT_EQ(take_all(arrivals).size(), 1U);
  arrivals.announce();
  EXPECT_TRUE(arrivals.wait(std::chrono::nanoseconds(1)));
}

}  // namespace
}  // namespace topogeo::messaging::detail
