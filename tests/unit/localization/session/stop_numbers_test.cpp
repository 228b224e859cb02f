#include "stop_numbers.hpp"

#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

/// Two parts of one stop each; of their stops only the number counts here.
struct StopNumbersTest : ::testing::Test {
  static std::unique_ptr<MapPart> part(std::uint64_t session) {
    auto stored = std::make_shared<StoredMap>();
    stored->maps.resize(1);
    stored->maps.front().stop = {session, 0};
    stored->trajectory.stops.resize(1);
    stored->trajectory.stops.front().stop = {session, 0};
    return std::make_unique<MapPart>(static_cast<std::uint32_t>(session), std::move(stored));
  }
  [[nodiscard]] PartOrder order(std::uint32_t of_a, std::uint32_t of_b) const {
    return {{a.get(), of_a}, {b.get(), of_b}};
  }
  [[nodiscard]] std::vector<std::uint32_t> numbered() const {
    std::vector<std::uint32_t> stops;
    for (const PartStretch& stretch : numbers.order()) stops.push_back(stretch.stops);
    return stops;
  }
  using Stops = std::vector<std::uint32_t>;

  std::unique_ptr<MapPart> a = part(1);
  std::unique_ptr<MapPart> b = part(2);
  StopNumbers numbers;
};

TEST_F(StopNumbersTest, WhatComesToTheEndKeepsTheNumbersOfAll) {
  numbers.update({{a.get(), 5}}, false, 5);
  numbers.update({{a.get(), 6}}, false, 6);
  numbers.update(order(6, 3), false, 7);
  numbers.update(order(6, 4), false, 8);
  EXPECT_EQ(numbered(), (Stops{6, 4}));
  EXPECT_EQ(numbers.numbered_since(), 0U);
}

TEST_F(StopNumbersTest, WhatComesBeforeOthersWaitsUntilItIsWorthOtherNumbers) {
  numbers.update(order(6, 4), false, 1);
  numbers.update(order(6 + StopNumbers::kTogether - 1, 5), false, 2);
  EXPECT_EQ(numbered(), (Stops{6, 5}));
  EXPECT_EQ(numbers.numbered_since(), 0U);
  numbers.update(order(6 + StopNumbers::kTogether, 5), false, 3);
  EXPECT_EQ(numbered(), (Stops{22, 5}));
  EXPECT_EQ(numbers.numbered_since(), 3U);
  numbers.update(order(23, 5), true, 4);
  EXPECT_EQ(numbered(), (Stops{23, 5}));
  EXPECT_EQ(numbers.numbered_since(), 4U);
}

TEST_F(StopNumbersTest, StopsThatHaveLeftChangeTheNumbers) {
  numbers.update(order(6, 4), false, 1);
  numbers.update(order(5, 4), false, 2);
  EXPECT_EQ(numbered(), (Stops{5, 4}));
  EXPECT_EQ(numbers.numbered_since(), 2U);
}

}  // namespace
}  // namespace topogeo::localization
