#include "base_watch.hpp"

#include <gtest/gtest.h>

#include "post_scan.hpp"

namespace topogeo::navigation {
namespace {

TEST(BaseWatch, NoticesABaseThatDoesNotMove) {
  BaseWatch watch(2.0);
  const geometry::Velocity ordered{0.3, 0.0};
  EXPECT_FALSE(watch.stuck(ordered, {}, 0));
  EXPECT_FALSE(watch.stuck(ordered, {0.005, 0.0, 0.0}, 1 * kSecond_ns));
  EXPECT_TRUE(watch.stuck(ordered, {0.005, 0.0, 0.0}, 2 * kSecond_ns));
  EXPECT_FALSE(watch.stuck(ordered, {0.1, 0.0, 0.0}, 3 * kSecond_ns));
  EXPECT_FALSE(watch.stuck({}, {0.1, 0.0, 0.0}, 9 * kSecond_ns));
  EXPECT_FALSE(watch.stuck({0.0, 0.5}, {0.1, 0.0, 0.0}, 10 * kSecond_ns));
  EXPECT_TRUE(watch.stuck({0.0, 0.5}, {0.1, 0.0, 0.0}, 12 * kSecond_ns));
}

}  // namespace
}  // namespace topogeo::navigation
