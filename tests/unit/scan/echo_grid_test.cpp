#include "topogeo/scan/echo_grid.hpp"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>

namespace topogeo::scan {
namespace {

using testing::ElementsAre;
using testing::FloatNear;

Echo echo_at(double angle_rad, double range_m) {
  return {angle_rad, {range_m * std::cos(angle_rad), range_m * std::sin(angle_rad)}};
}

TEST(EchoGrid, ABeamBetweenTwoEchoesOfAWallMeetsTheWall) {
  // The wall x = 2, seen at 0 and 0.05 rad; the beam at 0.025 rad meets it at 2 / cos(0.025).
  const std::vector<float> ranges_m =
      on_grid({echo_at(0.05, 2.0 / std::cos(0.05)), echo_at(0.0, 2.0)}, {0.025, 0.04, 1});
  EXPECT_THAT(ranges_m, ElementsAre(FloatNear(static_cast<float>(2.0 / std::cos(0.025)), 1e-5F)));
}

TEST(EchoGrid, ABeamAtAnEdgeTakesTheNearerEcho) {
  const std::vector<Echo> echoes{echo_at(0.0, 2.0), echo_at(0.05, 4.0)};
  EXPECT_THAT(on_grid(echoes, {0.01, 0.06, 1}), ElementsAre(FloatNear(2.0F, 1e-6F)));
  EXPECT_THAT(on_grid(echoes, {0.04, 0.06, 1}), ElementsAre(FloatNear(4.0F, 1e-6F)));
}

TEST(EchoGrid, BeamsFarFromAnyEchoHaveNone) {
  EXPECT_THAT(on_grid({echo_at(0.0, 2.0)}, {-0.2, 0.1, 5}),
              ElementsAre(0.0F, 0.0F, FloatNear(2.0F, 1e-6F), 0.0F, 0.0F));
  EXPECT_THAT(on_grid({}, {0.0, 0.1, 2}), ElementsAre(0.0F, 0.0F));
}

}  // namespace
}  // namespace topogeo::scan
