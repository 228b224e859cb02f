#include "server/places.hpp"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/transit_clock.hpp"

namespace topogeo::web {
namespace {

class Visitor final : public Places::Guest {
 public:
  using Guest::Guest;
  ~Visitor() { Places::leave(*this); }
  bool gone = false;

 private:
  void give_way() override { gone = true; }
};

TEST(Places, WhoWasSilentLongestGivesWay) {
  Places places(2);
  Visitor first("a");
  Visitor second("a");
  Visitor third("a");
  EXPECT_TRUE(places.enter(first));
  EXPECT_TRUE(places.enter(second));
  Places::touch(first);
  EXPECT_FALSE(places.enter(third));
  EXPECT_FALSE(first.gone);
  EXPECT_TRUE(second.gone);
  EXPECT_EQ(places.size(), 2U);
}

TEST(Places, AnAddressWithManyGivesWayBeforeOneWithFew) {
  Places places(4);
  Visitor quiet("tablet");
  places.enter(quiet);
  std::vector<std::unique_ptr<Visitor>> crowd;
  for (int i = 0; i < 20; ++i) {
    crowd.push_back(std::make_unique<Visitor>("stranger"));
    places.enter(*crowd.back());
  }
  EXPECT_FALSE(quiet.gone);
  EXPECT_EQ(places.size(), 4U);
}

TEST(Places, OfAddressesWithAsManyTheSilentOneGivesWay) {
  Places places(2);
  Visitor quiet("z");
  Visitor busy("a");
  Visitor third("m");
  places.enter(quiet);
  places.enter(busy);
  places.enter(third);
  EXPECT_TRUE(quiet.gone);
  EXPECT_FALSE(busy.gone);
}

TEST(Places, AGuestHasOnePlace) {
  Places strangers(1);
  Places operators(1);
  Visitor guest("a");
  strangers.enter(guest);
  operators.enter(guest);
  EXPECT_EQ(strangers.size(), 0U);
  EXPECT_EQ(operators.size(), 1U);
  Places::leave(guest);
  Places::leave(guest);
  Places::touch(guest);
  EXPECT_EQ(operators.size(), 0U);
}

TEST(TransitClock, TheQuickestIsNotLateAndTheOthersAreBySoMuch) {
  TransitClock clock;
  EXPECT_EQ(clock.lateness_s(100.0, 5.0), 0.0);
  EXPECT_NEAR(clock.lateness_s(100.1, 5.3), 0.2, 1e-3);
  EXPECT_EQ(clock.lateness_s(100.5, 5.4), 0.0) << "quicker than the first one";
  EXPECT_NEAR(clock.lateness_s(101.0, 11.9), 6.0, 2e-3);
}

TEST(TransitClock, ADriftOfTheClocksIsNoLateness) {
  TransitClock clock;
  constexpr double kHour_s = 3600.0;
  for (double page_s = 0.0; page_s < 8.0 * kHour_s; page_s += 10.0) {
    ASSERT_LT(clock.lateness_s(page_s, page_s * (1.0 + 1e-4)), 0.01) << page_s;
  }
}

}  // namespace
}  // namespace topogeo::web
