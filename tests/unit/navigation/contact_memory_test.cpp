#include "contact_memory.hpp"

#include <gtest/gtest.h>

#include "post_scan.hpp"

namespace topogeo::navigation {
namespace {

TEST(ContactMemory, TheSameContactAgainPushesNoOtherOut) {
  ContactMemory contacts;
  contacts.add({1.0, 0.0}, 0);
  for (std::int64_t i = 0; i < 50; ++i) contacts.add({2.0, 0.0005 * static_cast<double>(i)}, i);
  ASSERT_EQ(contacts.points_m(50).size(), 2U);
  EXPECT_EQ(contacts.points_m(50).front(), Eigen::Vector2d(1.0, 0.0));
  // A contact expires twelve seconds after it was last met.
  EXPECT_EQ(contacts.points_m(12 * kSecond_ns).size(), 1U);
  EXPECT_TRUE(contacts.points_m(12 * kSecond_ns + 50).empty());
  for (int i = 0; i < 30; ++i) contacts.add({0.1 * i, 5.0}, 60);
  EXPECT_EQ(contacts.points_m(60).size(), ContactMemory::kMost);
  contacts.clear();
  EXPECT_TRUE(contacts.points_m(60).empty());
}

}  // namespace
}  // namespace topogeo::navigation
