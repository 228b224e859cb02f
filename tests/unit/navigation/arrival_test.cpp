// A robot at the end of its path, with settings that let it settle for half a second.
#include "arrival.hpp"

#include <gtest/gtest.h>

#include "post_scan.hpp"

namespace topogeo::navigation {
namespace {

using Kind = ArrivalStep::Kind;

class ArrivalTest : public testing::Test {
 protected:
  ArrivalTest() {
    view.T_map_robot = {2.0, 3.0, 0.0};
    view.goal_m = {2.0, 3.0};
    view.tracking = true;
  }

  /// It stands until there is a pose from this place.
  ArrivalStep settle() {
    now_ns += kSecond_ns;
    arrival.begin(now_ns);
    now_ns += kSecond_ns;
    view.fix_ns = now_ns;
    return arrival.step(view, now_ns);
  }

  NavigatorConfig config;
  Arrival arrival{config};
  ArrivalView view;
  std::int64_t now_ns = 0;
};

TEST_F(ArrivalTest, StandsUntilAPoseOfThisPlaceHasCome) {
  arrival.begin(0);
  EXPECT_TRUE(arrival.settling());
  view.fix_ns = kSecond_ns / 10;  // from before it stopped
  EXPECT_EQ(arrival.step(view, kSecond_ns / 4).kind, Kind::kStands);
  EXPECT_EQ(arrival.step(view, kSecond_ns).kind, Kind::kStands);
  view.fix_ns = kSecond_ns;
  EXPECT_EQ(arrival.step(view, kSecond_ns).kind, Kind::kArrived);
}

TEST_F(ArrivalTest, DoesNotWaitForEverForAPose) {
  arrival.begin(0);
  EXPECT_EQ(arrival.step(view, 2 * kSecond_ns).kind, Kind::kArrived);
}

TEST_F(ArrivalTest, CorrectsCentimetresFiveTimesAtMostAndMoreTwelveTimes) {
  view.heading_rad = 0.5;
  for (const auto& [off_m, tries] : {std::pair(0.04, 5), std::pair(0.1, 12)}) {
    view.goal_m = {2.0 + off_m, 3.0};
    arrival.reset();
    for (int i = 0; i < tries; ++i) {
      const ArrivalStep step = settle();
      ASSERT_EQ(step.kind, Kind::kMoves) << i;
      EXPECT_NEAR(step.path.back().distance_m, off_m, 1e-9);
      EXPECT_EQ(step.heading_rad, 0.5);
      EXPECT_FALSE(arrival.settling());
    }
    EXPECT_EQ(settle().kind, Kind::kArrived) << off_m;
  }
  arrival.reset();
  EXPECT_EQ(settle().message, "corrects 0.10 m at the goal");
}

TEST_F(ArrivalTest, CorrectsAHeadingWithoutAPath) {
  view.heading_rad = 0.5;
  const ArrivalStep step = settle();
  EXPECT_EQ(step.kind, Kind::kMoves);
  EXPECT_TRUE(step.path.empty());
}

TEST_F(ArrivalTest, TurnsOnceRoundForAPoseThatIsNotSure) {
  view.tracking = false;
  double turned_rad = 0.0;
  for (int i = 0; i < 3; ++i) {
    const ArrivalStep step = settle();
    ASSERT_EQ(step.kind, Kind::kMoves) << i;
    turned_rad += *step.heading_rad - view.T_map_robot.theta_rad;
  }
  EXPECT_GT(turned_rad, 6.2);
  const ArrivalStep last = settle();
  EXPECT_EQ(last.kind, Kind::kArrived);
  EXPECT_EQ(last.message, "arrived (estimated error 0 cm, position unsure)");
  arrival.reset();
  EXPECT_EQ(settle().kind, Kind::kMoves);
}

TEST_F(ArrivalTest, APositionThatItCannotReachIsAccepted) {
  view.goal_m = {2.1, 3.0};
  arrival.accept_position();
  EXPECT_EQ(settle().kind, Kind::kArrived);
}

TEST_F(ArrivalTest, MarkovLocalizationLooksOnceEachTime) {
  arrival.note_look();
  EXPECT_FALSE(arrival.needs_look());
  arrival.begin(0);
  EXPECT_TRUE(arrival.needs_look());
  arrival.note_look();
  EXPECT_FALSE(arrival.needs_look());
  arrival.begin(kSecond_ns);
  EXPECT_TRUE(arrival.needs_look());
  arrival.interrupt();
  EXPECT_FALSE(arrival.settling());
}

}  // namespace
}  // namespace topogeo::navigation
