#include "topogeo/host_units.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::cli {
namespace {

using testing::ElementsAre;
using testing::FieldsAre;
using testing::IsEmpty;

TEST(HostUnitsTest, TellsThoseThatDoNotRunFromTheOthers) {
  EXPECT_THAT(
      idle_units("topogeo-local-mapper.service loaded active running a mapper that failed\n"
                 "topogeo-localizer.service loaded failed failed topogeo: poses\n"
                 "topogeo-map-store.service loaded activating auto-restart topogeo: map\n"
                 "topogeo-planner.service loaded inactive dead topogeo: ways\n"
                 "topogeo-worker@1.service loaded activating start topogeo: searches\n"
                 "topogeo-worker@2.service loaded failed failed topogeo: searches\n"),
      ElementsAre(FieldsAre("topogeo-localizer", false), FieldsAre("topogeo-map-store", true),
                  FieldsAre("topogeo-worker@2", false)));
  EXPECT_THAT(idle_units(""), IsEmpty());
  EXPECT_THAT(idle_units("System has not been booted\n"), IsEmpty());
}

}  // namespace
}  // namespace topogeo::cli
