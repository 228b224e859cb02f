// The mounting of the laser that is in force: that of the configuration or that of the log.
#include "topogeo/pipeline/laser_mounting.hpp"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::pipeline {
namespace {

using geometry::Pose2;
using testing::HasSubstr;
using testing::IsEmpty;

class LaserMountingTest : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file_); }

  LoadedConfig load(const std::string& yaml) {
    std::ofstream(file_) << yaml;
    return load_config(file_);
  }

  std::filesystem::path file_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("topogeo_mounting_") +
       testing::UnitTest::GetInstance()->current_test_info()->name() + ".yaml");
};

TEST_F(LaserMountingTest, OneKeyOfTheSectionSetsTheMounting) {
  EXPECT_FALSE(load_config({}).laser_set);
  EXPECT_FALSE(load("stop: {distance_m: 0.5}\n").laser_set);
  EXPECT_TRUE(load("laser: {x_m: 0}\n").laser_set);
  EXPECT_TRUE(load("laser: {y_m: 1}\n").laser_set);
  EXPECT_TRUE(load("laser.yaw_rad: -0.2\n").laser_set);
}

TEST_F(LaserMountingTest, TheLogHoldsWhereTheConfigurationSetsNothing) {
  LoadedConfig config = load("stop: {distance_m: 0.5}\n");
  const std::uint64_t before = config.effective.fingerprint;
  EXPECT_EQ(choose_mounting(config, Pose2{0.25, -0.1, 0.5}),
            "laser 0.250 m ahead, -0.100 m to the left, 28.6 deg: from the log");
  EXPECT_EQ(config.config.local_mapper.T_robot_laser, (Pose2{0.25, -0.1, 0.5}));
  EXPECT_EQ(config.config.local_mapper.voronoi.forward_rad, -0.5);
  // The effective configuration equals one in which the mounting is configured.
  const LoadedConfig same =
      load("stop: {distance_m: 0.5}\nlaser: {x_m: 0.25, y_m: -0.1, yaw_rad: 0.5}\n");
  EXPECT_EQ(config.effective.values, same.effective.values);
  EXPECT_EQ(config.effective.fingerprint, same.effective.fingerprint);
  EXPECT_NE(config.effective.fingerprint, before);
}

TEST_F(LaserMountingTest, ALogWithoutAMountingOrWithZerosChangesNothing) {
  for (const auto& in_log : {std::optional<Pose2>(), std::optional<Pose2>(Pose2{})}) {
    LoadedConfig config = load_config({});
    EXPECT_THAT(choose_mounting(config, in_log), IsEmpty());
    EXPECT_EQ(config.config.local_mapper.T_robot_laser, Pose2{});
    EXPECT_EQ(config.effective.fingerprint, load_config({}).effective.fingerprint);
  }
}

TEST_F(LaserMountingTest, TheConfigurationWinsAndAContradictionIsReported) {
  LoadedConfig config = load("laser: {x_m: 0.3}\n");
  EXPECT_EQ(choose_mounting(config, Pose2{0.25, 0.0, 0.0}),
            "warning: laser 0.300 m ahead, 0.000 m to the left, 0.0 deg: from the configuration, "
            "but the log states 0.250 m ahead, 0.000 m to the left, 0.0 deg");
  EXPECT_THAT(choose_mounting(config, Pose2{0.3, 0.0, 0.02}), HasSubstr("1.1 deg"));
  EXPECT_THAT(choose_mounting(config, Pose2{0.31, 0.01, 0.01}), IsEmpty());
  EXPECT_THAT(choose_mounting(config, std::nullopt), IsEmpty());
  EXPECT_EQ(config.config.local_mapper.T_robot_laser, (Pose2{0.3, 0.0, 0.0}));
}

TEST_F(LaserMountingTest, AnArgumentKeepsEveryDigit) {
  for (const Pose2& mounting :
       {Pose2{}, Pose2{1.0 / 3.0, -2.0 / 7.0, 3.14159}, Pose2{1e-5, 0, 0}}) {
    EXPECT_EQ(parse_mounting(mounting_argument(mounting)), mounting);
  }
}

TEST_F(LaserMountingTest, OtherTextsAreNoMounting) {
  for (const char* text : {"", "1,2", "1,2,3,4", "a,0,0", "0,0,nan", "9,0,0", "0,0,4", " "}) {
    EXPECT_THROW((void)parse_mounting(text), std::invalid_argument) << text;
  }
}

}  // namespace
}  // namespace topogeo::pipeline
