#include "topogeo/pipeline/localization_run.hpp"

#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::pipeline {
namespace {

TEST(ParsePose, TakesMetresAndDegrees) {
  const geometry::Pose2 pose = parse_pose("1.5,-2,-450");
  EXPECT_EQ(pose.x_m, 1.5);
  EXPECT_EQ(pose.y_m, -2.0);
  EXPECT_NEAR(pose.theta_rad, -std::numbers::pi / 2.0, 1e-12);
}

TEST(ParsePose, RefusesAnythingElse) {
  for (const char* text : {"", "1", "1,2", "1,2,", ",2,3", "1,2,3,4", "1,two,3", "1,2,3x",
                           "nan,0,0", "0,0,1e9", "1e999,0,0"}) {
    EXPECT_THROW(parse_pose(text), std::invalid_argument) << text;
  }
}

TEST(LocalizationCsv, HasALineForEachStop) {
  localization::LocalizedStop stop;
  stop.stop.number = 3;
  stop.stamp_ns = 1'500'000'000;
  stop.T_map_robot = {1.0, -2.0, 0.5};
  stop.covariance = Eigen::Vector3d(0.01, 0.04, 0.0001).asDiagonal();
  stop.status = {localization::LocalizationState::kAmbiguous, 0.25};
  stop.accepted_matches = 2;
  EXPECT_EQ(localization_csv(std::vector{stop}),
            "stop,stamp_s,x_m,y_m,theta_rad,state,confidence,sigma_x_m,sigma_y_m,sigma_theta_rad,"
            "accepted_matches\n"
            "3,1.500000,1.000000,-2.000000,0.500000,AMBIGUOUS,0.2500,0.1000,0.2000,0.0100,2\n");
}

TEST(LoadStoredMap, NamesTheFileThatIsNoMap) {
  EXPECT_THROW(load_stored_map("/nonexistent/map.pb"), std::runtime_error);
}

}  // namespace
}  // namespace topogeo::pipeline
