#include "topogeo/common/host_units.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::cli {
namespace {

using testing::ElementsAre;
using testing::FieldsAre;
using testing::IsEmpty;

TEST(HostUnitsTest, TellsThoseThatDoNotRunFromTheOthers) {
  const HostUnits units = host_units(
      "NRestarts=4\nId=topogeo-worker@2.service\nActiveState=failed\nSubState=failed\n"
      "\n"
      "NRestarts=7\nId=topogeo-local-mapper.service\nActiveState=active\nSubState=running\n"
      "\n"
      "NRestarts=0\nId=topogeo-localizer.service\nActiveState=failed\nSubState=failed\n"
      "\n"
      "NRestarts=0\nId=topogeo-planner.service\nActiveState=inactive\nSubState=dead\n"
      "\n"
      "NRestarts=1\nId=topogeo-map-store.service\nActiveState=activating\n"
      "SubState=auto-restart\n"
      "\n"
      "NRestarts=0\nId=topogeo-worker@1.service\nActiveState=activating\nSubState=start\n"
      "\n"
      "NRestarts=0\nId=topogeo-web.service\nActiveState=active\nSubState=running\n");
  EXPECT_THAT(units.idle, ElementsAre(FieldsAre("topogeo-localizer", false),
                                      FieldsAre("topogeo-map-store", true),
                                      FieldsAre("topogeo-worker@2", false)));
  EXPECT_EQ(units.on_domain, 2U) << "local mapper and web";
}

TEST(HostUnitsTest, OneThatIsStartedAgainAndAgainDoesNotRunWhileItStarts) {
  EXPECT_THAT(host_units("NRestarts=12\nId=topogeo-navigator.service\nActiveState=activating\n"
                         "SubState=start\n")
                  .idle,
              ElementsAre(FieldsAre("topogeo-navigator", true)));
}

TEST(HostUnitsTest, DiscoveryServersJoinNoDomain) {
  EXPECT_EQ(host_units("Id=topogeo-discovery@0.service\nActiveState=active\n").on_domain, 0U);
  const HostUnits failed = host_units("Id=topogeo-discovery@0.service\nActiveState=failed\n");
  EXPECT_THAT(failed.idle, ElementsAre(FieldsAre("topogeo-discovery@0", false)));
}

TEST(HostUnitsTest, OtherTextsNameNone) {
  for (const char* text : {"", "\n\n", "System has not been booted\n", "Version=252\n",
                           "Id=topogeo.target\nActiveState=active\n"}) {
    const HostUnits units = host_units(text);
    EXPECT_THAT(units.idle, IsEmpty()) << text;
    EXPECT_EQ(units.on_domain, 0U) << text;
  }
}

}  // namespace
}  // namespace topogeo::cli
