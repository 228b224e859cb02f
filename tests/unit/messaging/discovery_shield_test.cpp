#include "fast_dds/discovery_shield.hpp"

#include <gtest/gtest.h>

namespace topogeo::messaging {
namespace {

using Duration = eprosima::fastrtps::Duration_t;

TEST(DiscoveryShield, LeasesAreBounded) {
  EXPECT_EQ(bounded_lease(Duration(0, 0)), Duration(10, 0)) << "none was announced";
  EXPECT_EQ(bounded_lease(Duration(0, 4'000'000)), Duration(10, 0));
  EXPECT_EQ(bounded_lease(Duration(10, 0)), Duration(10, 0));
  EXPECT_EQ(bounded_lease(Duration(30, 5)), Duration(30, 5));
  EXPECT_EQ(bounded_lease(Duration(4'000'000, 0)), Duration(120, 0));
  EXPECT_EQ(bounded_lease(eprosima::fastrtps::c_TimeInfinite), Duration(120, 0));
}

}  // namespace
}  // namespace topogeo::messaging
