#include "topogeo/planning/place_names.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::planning {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const std::vector<Place> kPlaces{{"room A", {1, 0}}, {"Kitchen", {2, 0}}, {"hall", {3, 0}},
                                 {"Hall", {4, 0}},   {"room B", {5, 0}},  {"HaLL", {6, 0}}};

TEST(PlaceNames, TheExactNameComesFirst) {
  ASSERT_NE(find_place(kPlaces, "Hall"), nullptr);
  EXPECT_EQ(find_place(kPlaces, "Hall")->position_m.x(), 4.0);
  EXPECT_EQ(find_place(kPlaces, "hall")->position_m.x(), 3.0);
}

TEST(PlaceNames, OtherCapitalsWillDoWhenOnlyOnePlaceIsMeant) {
  ASSERT_NE(find_place(kPlaces, "ROOM a"), nullptr);
  EXPECT_EQ(find_place(kPlaces, "ROOM a")->name, "room A");
  EXPECT_EQ(find_place(kPlaces, "HALL"), nullptr) << "three places could be meant";
  EXPECT_EQ(find_place(kPlaces, "room"), nullptr);
  EXPECT_EQ(find_place({}, "room A"), nullptr);
}

TEST(PlaceNames, SimilarNamesAreThoseOfFewestChanges) {
  EXPECT_THAT(similar_names(kPlaces, "kitchn", 1), ElementsAre("Kitchen"));
  EXPECT_THAT(similar_names(kPlaces, "HALL", 3), ElementsAre("hall", "Hall", "HaLL"));
  EXPECT_THAT(similar_names(kPlaces, "room C", 2), ElementsAre("room A", "room B"));
  EXPECT_THAT(similar_names(kPlaces, "x", 0), IsEmpty());
  EXPECT_EQ(similar_names(kPlaces, "", 9).size(), kPlaces.size());
}

TEST(PlaceNames, BaseStationByItsNameOrAsTheOnlyOne) {
  std::vector<Place> places{{"base station", {1.0, 2.0}}, {"dock", {3.0, 4.0}, 0.5}};
  EXPECT_EQ(find_base_station(places, "Dock")->name, "dock");
  EXPECT_EQ(find_base_station(places, "base station")->name, "dock") << "the other has no heading";
  places.push_back({"lift", {5.0, 6.0}, 1.5});
  EXPECT_EQ(find_base_station(places, "lift")->name, "lift");
  EXPECT_EQ(find_base_station(places, "base station")->name, "base station");
  EXPECT_EQ(find_base_station(places, "yard"), nullptr) << "two could be meant";
}

TEST(PlaceNames, BaseStationTurnsWithItsFrame) {
  const Place moved_place = moved({"dock", {1.0, 0.0}, 3.0}, {10.0, 0.0, M_PI_2});
  EXPECT_NEAR((moved_place.position_m - Eigen::Vector2d(10.0, 1.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(*moved_place.station_heading_rad, 3.0 + M_PI_2 - 2.0 * M_PI, 1e-12);
  EXPECT_FALSE(moved({"room", {1.0, 0.0}}, {10.0, 0.0, M_PI_2}).station_heading_rad);
}

}  // namespace
}  // namespace topogeo::planning
