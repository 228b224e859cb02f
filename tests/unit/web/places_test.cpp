#include "server/places.hpp"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace topogeo::web
