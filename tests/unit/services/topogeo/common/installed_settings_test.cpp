#include "topogeo/common/installed_settings.hpp"

#include <sstream>

#include <gmock/gmock.h>

namespace topogeo::cli {
namespace {

using testing::ElementsAre;
using testing::Pair;

TEST(InstalledSettings, AreReadAsSystemdReadsThem) {
  std::istringstream file(
      "# TOPOGEO_DOMAIN=1\n"
      "; TOPOGEO_DOMAIN=2\n"
      "TOPOGEO_DOMAIN=7\r\n"
      "  TOPOGEO_ROBOT = \"anna of floor 3\" \n"
      "TOPOGEO_PEERS='10.0.0.1;10.0.0.2'\n"
      "ROS_DISCOVERY_SERVER=\n"
      "no variable\n"
      "LOCALIZER_OPTIONS=\"--config /etc/topogeo/topogeo.yaml --seed=3\"\n"
      "QUOTE=\"\n");
  EXPECT_THAT(environment_in(file),
              ElementsAre(Pair("LOCALIZER_OPTIONS", "--config /etc/topogeo/topogeo.yaml --seed=3"),
                          Pair("QUOTE", "\""), Pair("ROS_DISCOVERY_SERVER", ""),
                          Pair("TOPOGEO_DOMAIN", "7"), Pair("TOPOGEO_PEERS", "10.0.0.1;10.0.0.2"),
                          Pair("TOPOGEO_ROBOT", "anna of floor 3")));
}

TEST(InstalledSettings, AreNoneWhereThereIsNoFile) {
  std::istringstream file;
  file.setstate(std::ios::failbit);
  EXPECT_TRUE(environment_in(file).empty());
}

}  // namespace
}  // namespace topogeo::cli
