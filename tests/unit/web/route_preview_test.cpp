#include "orders/route_preview.hpp"

#include <numbers>

#include <gtest/gtest.h>

namespace topogeo::web {
namespace {

navigation::FollowerConfig follower() {
  navigation::FollowerConfig config;
  config.speed_m_per_s = 0.5;
  config.turn_rad_per_s = 1.0;
  config.acceleration_m_per_s2 = 0.5;
  return config;
}

TEST(DriveTime, IsThatOfLengthsTurnsAndTheStart) {
  EXPECT_EQ(drive_time_s({}, follower()), 0.0);
  EXPECT_EQ(drive_time_s({{1.0, 1.0}}, follower()), 0.0);
  EXPECT_DOUBLE_EQ(drive_time_s({{0.0, 0.0}, {3.0, 0.0}}, follower()), 1.0 + 6.0);
  EXPECT_DOUBLE_EQ(drive_time_s({{0.0, 0.0}, {3.0, 0.0}, {3.0, -1.0}}, follower()),
                   1.0 + 8.0 + std::numbers::pi / 2.0);
}

TEST(RoutePreview, WithoutAMapThereIsNoRoute) {
  const Answer answer = preview_route({}, {0.0, 0.0}, {{1.0, 1.0}}, {}, follower());
  EXPECT_EQ(answer.status, 200U);
  EXPECT_NE(answer.body.find(R"("found":false)"), std::string::npos) << answer.body;
}

}  // namespace
}  // namespace topogeo::web
