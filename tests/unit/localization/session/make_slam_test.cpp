#include "topogeo/session/make_slam.hpp"

#include <gtest/gtest.h>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/slam/pose_graph_slam.hpp"
#include "topogeo/thesis/thesis_slam.hpp"

namespace topogeo::localization {
namespace {

TEST(MakeSlam, MakesTheAlgorithmThatTheModeNames) {
  InProcessPool pool;
  LocalizerConfig config;
  EXPECT_NE(dynamic_cast<PoseGraphSlam*>(make_slam(config, pool).get()), nullptr);
  config.mode = SlamAlgorithm::kThesis;
  EXPECT_NE(dynamic_cast<ThesisSlam*>(make_slam(config, pool).get()), nullptr);
}

}  // namespace
}  // namespace topogeo::localization
