#include "local_mapper/sent_maps.hpp"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::local_mapper {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Stop = topomap::StopId;

constexpr std::uint64_t kDrive = 71;
constexpr std::uint64_t kDriveAfter = 5;

/// Keeps two of the stored maps, and at least five in all.
SentMaps sent(std::uint32_t stops) {
  SentMaps maps({.stored = 2, .unstored = 5});
  for (std::uint32_t i = 0; i < stops; ++i) maps.add({kDrive, i});
  return maps;
}

TEST(SentMaps, KeepsWhatIsNotStored) {
  SentMaps maps = sent(5);
  EXPECT_THAT(maps.take_old(true), IsEmpty()) << "no map store was heard";
  maps.set_stored(kDrive, 0);
  EXPECT_THAT(maps.take_old(true), IsEmpty());
  maps.set_stored(kDrive, 2);
  EXPECT_THAT(maps.take_old(false), ElementsAre(Stop{kDrive, 0}, Stop{kDrive, 1}));
  EXPECT_THAT(maps.take_old(false), IsEmpty());
  EXPECT_EQ(maps.size(), 3U);
}

TEST(SentMaps, KeepsTheNewestThoughTheyAreStored) {
  SentMaps maps = sent(5);
  maps.set_stored(kDrive, 5);
  EXPECT_EQ(maps.take_old(false).size(), 3U);
  EXPECT_EQ(maps.size(), 2U);
}

TEST(SentMaps, KeepsNoMoreThanSoManyWhateverIsStored) {
  SentMaps maps = sent(7);
  EXPECT_THAT(maps.take_old(false), ElementsAre(Stop{kDrive, 0}, Stop{kDrive, 1}));
  maps.add({kDrive, 7});
  EXPECT_THAT(maps.take_old(false), ElementsAre(Stop{kDrive, 2}));
}

TEST(SentMaps, DropsASessionWhenTheNextOneIsStored) {
  SentMaps maps = sent(3);
  maps.add({kDriveAfter, 0});
  maps.set_stored(kDrive, 3);
  EXPECT_THAT(maps.take_old(true), IsEmpty()) << "the store does not know the new session yet";
  maps.set_stored(kDriveAfter, 0);
  EXPECT_THAT(maps.take_old(false), ElementsAre(Stop{kDrive, 0}, Stop{kDrive, 1}));
}

TEST(SentMaps, WhereNothingIsStoredItKeepsWhatAReaderIsYetToGet) {
  SentMaps maps = sent(2);
  maps.set_nothing_stored();
  EXPECT_FALSE(maps.depends_on_readers()) << "so few are kept in any case";
  maps.add({kDrive, 2});
  EXPECT_TRUE(maps.depends_on_readers());
  EXPECT_THAT(maps.take_old(false), IsEmpty());
  EXPECT_THAT(maps.take_old(true), ElementsAre(Stop{kDrive, 0}));
  maps.set_stored(kDrive, 0);
  maps.add({kDrive, 3});
  EXPECT_FALSE(maps.depends_on_readers()) << "another map store";
  EXPECT_THAT(maps.take_old(true), IsEmpty());
}

}  // namespace
}  // namespace topogeo::local_mapper
