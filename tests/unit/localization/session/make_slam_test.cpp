#include <stdexcept>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/session/slam_session.hpp"
#include "topogeo/slam/pose_graph_slam.hpp"

namespace topogeo::localization {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(MakeSlam, MakesThePoseGraph) {
  InProcessPool pool;
  EXPECT_NE(dynamic_cast<PoseGraphSlam*>(make_slam({}, pool).get()), nullptr);
}

TEST(MakeSlam, RefusesAnAlgorithmThatTheProgramDoesNotHave) {
  InProcessPool pool;
  LocalizerConfig config;
  config.mode = SlamAlgorithm::kThesis;
  const AddedModeConfig taken = std::move(config.added_mode);
  EXPECT_THAT([&] { make_slam(config, pool); },
              ThrowsMessage<std::invalid_argument>(
                  HasSubstr("localizer.mode: 'thesis' is not built into this program (CMake option "
                            "TOPOGEO_RESEARCH), expected 'graph'")));
}

}  // namespace
}  // namespace topogeo::localization
