#include "topogeo/pipeline/config.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::pipeline {
namespace {

using testing::HasSubstr;

class ConfigTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    file_ = std::filesystem::path(testing::TempDir()) /
            (std::string("topogeo_config_") + test->name() + ".yaml");
  }
  void TearDown() override { std::filesystem::remove(file_); }

  /// What load_config says of a file with this content; empty if it takes it.
  std::string complaint(const std::string& yaml) {
    std::ofstream(file_) << yaml;
    try {
      (void)load_config(file_);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return {};
  }

  std::filesystem::path file_;
};

TEST_F(ConfigTest, EveryKeyIsDocumentedAndItsDefaultIsInRange) {
  Config config;
  const support::ConfigSchema schema = describe(config);  // throws for a default out of range
  ASSERT_GT(schema.parameters().size(), 40U);
  for (const support::ConfigParameter& parameter : schema.parameters()) {
    EXPECT_GE(parameter.why.size(), 12U) << parameter.key;
    EXPECT_FALSE(parameter.expected.empty()) << parameter.key;
    EXPECT_TRUE(parameter.parse(parameter.default_text).has_value()) << parameter.key;
  }
}

TEST_F(ConfigTest, WrittenDefaultsReadBackToTheSameConfiguration) {
  Config config;
  std::ostringstream yaml;
  support::write_yaml(describe(config), yaml);
  EXPECT_EQ(complaint(yaml.str()), "");
  EXPECT_EQ(load_config(file_).effective.values, load_config({}).effective.values);
  EXPECT_EQ(load_config(file_).effective.fingerprint, load_config({}).effective.fingerprint);
}

TEST_F(ConfigTest, OneKeyReachesEveryVariableItStandsFor) {
  std::ofstream(file_) << "local_map:\n  range_limit_m: 6.5\n"
                       << "laser:\n  yaw_rad: 0.25\n"
                       << "odometry:\n  heading_rad2_per_m: 0.125\n";
  const Config config = load_config(file_).config;
  EXPECT_EQ(config.local_mapper.voronoi.range_limit_m, 6.5);
  EXPECT_EQ(config.local_mapper.T_robot_laser.theta_rad, 0.25);
  EXPECT_EQ(config.local_mapper.voronoi.forward_rad, -0.25);
  EXPECT_EQ(config.localizer.odometry.heading_rad2_per_m, 0.125);
  EXPECT_EQ(config.local_mapper.tracker.odometry.heading_rad2_per_m, 0.125);
}

TEST_F(ConfigTest, UnknownKeyIsNamedWithItsLine) {
  const std::string what = complaint("stop:\n  distance_m: 1\n  distanze_m: 2\n");
  EXPECT_THAT(what, HasSubstr(file_.string() + ":3:"));
  EXPECT_THAT(what, HasSubstr("stop.distanze_m"));
}

TEST_F(ConfigTest, ValueOutOfRangeIsNamedWithLineAndRange) {
  const std::string what = complaint("# slow robot\nstop:\n  distance_m: 50\n");
  EXPECT_THAT(what, HasSubstr(file_.string() + ":3:"));
  EXPECT_THAT(what, HasSubstr("stop.distance_m"));
  EXPECT_THAT(what, HasSubstr("50"));
  EXPECT_THAT(what, HasSubstr("between 0.1 and 10 m"));
}

TEST_F(ConfigTest, ValuesInRangeThatTheNavigatorCannotUseAreNamedWithTheFile) {
  const std::string even = complaint("markov:\n  window_cells: 20\n");
  EXPECT_THAT(even, HasSubstr(file_.string()));
  EXPECT_THAT(even, HasSubstr("window"));
  EXPECT_THAT(complaint("navigator:\n  min_radius_m: 3\n  max_radius_m: 2\n"), HasSubstr("radius"));
}

TEST_F(ConfigTest, TheHybridPlannerHasASection) {
  EXPECT_EQ(complaint("hybrid_planner:\n  start_snap_m: 0.5\n  piece_m: 0\n"), "");
  const Config config = load_config(file_).config;
  EXPECT_EQ(config.hybrid_planner.start_snap_m, 0.5);
  EXPECT_EQ(config.hybrid_planner.piece_m, 0.0);
  EXPECT_EQ(config.hybrid_planner.goal_snap_m, planning::HybridPlannerConfig{}.goal_snap_m);
  EXPECT_THAT(complaint("hybrid_planner:\n  goal_snap_m: 6\n"), HasSubstr("between 0 and 5 m"));
}

TEST_F(ConfigTest, MissingFileIsNamed) {
  try {
    (void)load_config("/nowhere/topogeo.yaml");
    FAIL() << "took a file that does not exist";
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("/nowhere/topogeo.yaml"));
  }
}

}  // namespace
}  // namespace topogeo::pipeline
