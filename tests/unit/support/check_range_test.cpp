#include "topogeo/support/check_range.hpp"

#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::support {
namespace {

using testing::StrEq;
using testing::ThrowsMessage;

TEST(CheckRange, TakesWhatLiesWithinBothEndsIncluded) {
  EXPECT_NO_THROW(check_range("width", 1.0, 1.0, 2.0));
  EXPECT_NO_THROW(check_range("width", 2.0, 1.0, 2.0));
  EXPECT_NO_THROW(check_range("width", 1.5, 1.0, 2.0));
}

TEST(CheckRange, NamesWhatTheValueAndTheRange) {
  EXPECT_THAT([] { check_range("reading 3", 7.5, 0.0, 2.5, "m"); },
              ThrowsMessage<std::invalid_argument>(StrEq("reading 3 is 7.5, expected 0 to 2.5 m")));
  EXPECT_THAT(
      [] { check_range("cells", 400000000, 1, 100000000); },
      ThrowsMessage<std::invalid_argument>(StrEq("cells is 400000000, expected 1 to 100000000")));
}

TEST(CheckRange, RefusesWhatIsNoNumber) {
  EXPECT_THROW(check_range("x", std::numeric_limits<double>::quiet_NaN(), -1.0, 1.0),
               std::invalid_argument);
  EXPECT_THROW(check_range("x", std::numeric_limits<double>::infinity(), -1.0, 1e300),
               std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::support
