#include "topogeo/session/odometry_chain.hpp"

#include <memory>

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

using geometry::Pose2;

OdometryChain::MapPointer stop(std::uint64_t session, std::uint32_t number, std::uint64_t epoch,
                               const Pose2& T_odom_robot, const Pose2& T_previous_robot) {
  auto map = std::make_shared<topomap::LocalMap>();
  map->stop = {session, number};
  map->odometry_epoch = epoch;
  map->T_odom_robot = T_odom_robot;
  map->T_previous_robot = T_previous_robot;
  return map;
}

void expect_at(const OdometryChain::MapPointer& map, const Pose2& T_odom_robot) {
  EXPECT_LT(geometry::difference(map->T_odom_robot, T_odom_robot).norm(), 1e-12);
}

TEST(OdometryChain, OneEpochStaysAsItIs) {
  OdometryChain chain;
  const auto map = stop(1, 0, 4, {5.0, 6.0, 1.0}, {});
  EXPECT_EQ(chain.add(map), map);
  const auto next = stop(1, 1, 4, {6.0, 6.0, 1.0}, {0.9, 0.1, 0.0});
  EXPECT_EQ(chain.add(next), next) << "odometry, not scan tracking";
}

TEST(OdometryChain, GoesOnOverANewEpochWhereScanTrackingHasTheRobot) {
  OdometryChain chain;
  static_cast<void>(chain.add(stop(1, 0, 4, {5.0, 6.0, 0.0}, {})));
  expect_at(chain.add(stop(1, 1, 9, {0.0, 0.0, 0.0}, {0.5, 0.0, 0.0})), {5.5, 6.0, 0.0});
  expect_at(chain.add(stop(1, 2, 9, {1.0, 0.0, 0.0}, {0.8, 0.0, 0.0})), {6.5, 6.0, 0.0});
  expect_at(chain.add(stop(1, 3, 2, {7.0, 7.0, 0.5}, {1.0, 0.0, 0.25})), {7.5, 6.0, 0.25});
}

TEST(OdometryChain, TheTrackBeforeANewEpochIsOfTheOldOne) {
  OdometryChain chain;
  static_cast<void>(chain.add(stop(1, 0, 4, {5.0, 6.0, 0.0}, {})));
  const auto with_track = [](const OdometryChain::MapPointer& map, const Pose2& T_odom_robot) {
    auto tracked = std::make_shared<topomap::LocalMap>(*map);
    tracked->track.push_back({0, 0, T_odom_robot, {}, true});
    return tracked;
  };
  const auto first =
      chain.add(with_track(stop(1, 1, 9, {0.0, 0.0, 0.0}, {0.5, 0.0, 0.0}), {5.4, 6.0, 0.0}));
  const auto next =
      chain.add(with_track(stop(1, 2, 9, {1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}), {0.3, 0.0, 0.0}));
  EXPECT_EQ(first->track[0].T_odom_robot, (Pose2{5.4, 6.0, 0.0}));
  EXPECT_LT(geometry::difference(next->track[0].T_odom_robot, {5.8, 6.0, 0.0}).norm(), 1e-12);
}

TEST(OdometryChain, GoesOnByTheScansWhereTheyContradictOdometry) {
  OdometryChain chain;
  static_cast<void>(chain.add(stop(1, 0, 4, {5.0, 6.0, 0.0}, {})));
  auto slipped =
      std::make_shared<topomap::LocalMap>(*stop(1, 1, 4, {6.5, 6.0, 0.0}, {0.1, 0.0, 0.0}));
  slipped->track.push_back({0, 0, {6.3, 6.0, 0.0}, {0.1, 0.0, 0.0}, true});
  const auto chained = chain.add(slipped);
  expect_at(chained, {5.1, 6.0, 0.0});
  EXPECT_EQ(chained->track[0].T_odom_robot, slipped->track[0].T_odom_robot);
  expect_at(chain.add(stop(1, 2, 4, {7.5, 6.0, 0.0}, {1.0, 0.0, 0.0})), {6.1, 6.0, 0.0});
}

TEST(OdometryChain, GoesOnAfterAStopOfAStoredMap) {
  OdometryChain chain;
  chain.start_after(*stop(1, 6, 4, {5.0, 6.0, 0.0}, {}));
  expect_at(chain.add(stop(1, 7, 9, {0.0, 0.0, 0.0}, {0.5, 0.0, 0.0})), {5.5, 6.0, 0.0});
}

// A restarted local mapper begins another session; the base's odometry continues or starts anew.
TEST(OdometryChain, AnotherSessionGoesOnInTheSameEpochOnly) {
  for (const std::uint64_t epoch : {9U, 7U}) {
    OdometryChain chain;
    static_cast<void>(chain.add(stop(1, 0, 4, {5.0, 6.0, 0.0}, {})));
    static_cast<void>(chain.add(stop(1, 1, 9, {0.0, 0.0, 0.0}, {0.5, 0.0, 0.0})));
    const double x_m = epoch == 9 ? 8.5 : 3.0;
    const double y_m = epoch == 9 ? 6.0 : 0.0;
    expect_at(chain.add(stop(2, 0, epoch, {3.0, 0.0, 0.0}, {})), {x_m, y_m, 0.0});
  }
}

}  // namespace
}  // namespace topogeo::localization
