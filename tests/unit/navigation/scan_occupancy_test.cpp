#include "scan_occupancy.hpp"

#include <gtest/gtest.h>

namespace topogeo::navigation {
namespace {

TEST(ScanOccupancy, SeesFreeOccupiedAndHidden) {
  ScanPoints scan;
  for (int i = -100; i <= 100; ++i) scan.points_m.emplace_back(2.0, 0.01 * i);
  const ScanOccupancy occupancy(scan);
  EXPECT_EQ(occupancy.at({1.0, 0.0}, 0.05), Occupancy::kFree);
  EXPECT_EQ(occupancy.at({2.0, 0.5}, 0.05), Occupancy::kOccupied);
  EXPECT_EQ(occupancy.at({3.0, 0.0}, 0.05), Occupancy::kUnseen);
  EXPECT_EQ(occupancy.at({-1.0, 0.0}, 0.05), Occupancy::kUnseen);
  EXPECT_EQ(occupancy.at({1.0, 1.0}, 0.05), Occupancy::kUnseen);  // beside the beams
}

}  // namespace
}  // namespace topogeo::navigation
