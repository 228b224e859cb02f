// Settings of Markov localization, from a configuration file to the navigator's pose.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/navigation/markov_tracker.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/planning/grid_sources.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/simulation/simulated_robot.hpp"
#include "topogeo/support/temporary_folder.hpp"
#include "topogeo/world/world.hpp"

#include "pose_sources.hpp"

namespace topogeo::pipeline {
namespace {

constexpr double kQuarter_rad = 0.5 * std::numbers::pi;
const geometry::Pose2 kStation{1.25, 1.55, 0.0};

/// Two rooms with a door, and a column that the map does not have.
world::World floor_with_column() {
  return world::parse_world(R"(
name: two rooms
walls:
  - {from: [0, 0], to: [10, 0]}
  - {from: [10, 0], to: [10, 6]}
  - {from: [10, 6], to: [0, 6]}
  - {from: [0, 6], to: [0, 0]}
  - {from: [5, 0], to: [5, 6], doors: [{at: 1.5, width: 1.0}]}
columns: [{center: [3.6, 2.6], radius: 0.2}]
tour: [[1, 1], [9, 1]]
)",
                            "two rooms");
}

/// Its walls, with two base stations and a place.
planning::HybridMap map_of_walls(const world::World& world) {
  planning::Drawing drawing;
  for (const auto& wall : world.segments) drawing.lines.push_back({wall.a_m, wall.b_m});
  drawing.inside_m = {kStation.position_m()};
  planning::FreeSpace space(planning::grid_of(drawing));
  planning::ZoneMap zones = planning::zones_by_width(space);
  return {
      std::move(space),
      std::move(zones),
      {{"base station", {1.25, 1.55}, 0.0}, {"dock", {1.35, 1.55}, 0.0}, {"shelf", {1.25, 1.65}}}};
}

class MarkovSettings : public testing::Test {
 protected:
  MarkovSettings() {
    options.T_world_start = kStation;
    options.laser = {0.0, 0.0, 0.0, 0.0};
    options.sonar.sigma_m = 0.0;
    options.odometry = {-0.05, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};  // 5 % too little
    put_at_start();
  }

  void put_at_start() {
    robot.emplace(world, options);
    stamp_ns = 0;
  }

  /// The section `markov` of a configuration file, as the navigator gets it.
  navigation::NavigatorConfig load(const std::string& settings) {
    const std::filesystem::path file = folder.path() / "robot.yaml";
    std::ofstream(file) << "navigator: {pose_source: markov}\nmarkov: {" << settings << "}\n";
    return load_config(file).config.navigator;
  }

  navigation::SonarRound sonars() {
    navigation::SonarRound round;
    round.stamp_ns = stamp_ns;
    const std::vector<float> ranges_m = robot->sonar();
    for (std::size_t i = 0; i < ranges_m.size(); ++i) {
      const auto& mount = robot->options().sonars[i];
      round.readings.push_back({mount.T_robot_sonar, mount.half_cone_rad, ranges_m[i]});
    }
    return round;
  }

  navigation::ScanPoints scan() {
    navigation::ScanPoints points;
    points.stamp_ns = stamp_ns;
    const auto& beams = robot->options().beams;
    const std::vector<float> ranges_m = robot->scan();
    for (std::size_t i = 0; i < ranges_m.size(); ++i) {
      const double angle_rad = beams.angle_min_rad + static_cast<double>(i) * beams.angle_step_rad;
      points.points_m.emplace_back(ranges_m[i] * std::cos(angle_rad),
                                   ranges_m[i] * std::sin(angle_rad));
    }
    return points;
  }

  /// Shift of the pose (map axes, metres) by a look after these motions, each a primitive.
  Eigen::Vector2d moved_by_look_m(const std::string& settings,
                                  const std::vector<simulation::Velocity>& motions) {
    navigation::MarkovTracker tracker(map.space().grid(), load(settings).markov);
    tracker.add({++stamp_ns, robot->T_odom_robot()});
    EXPECT_TRUE(tracker.start(kStation, sonars())) << tracker.reason();
    for (const simulation::Velocity& motion : motions) {
      robot->step(motion, 1.0);
      tracker.add({++stamp_ns, robot->T_odom_robot()});
      tracker.primitive_done();
    }
    const Eigen::Vector2d before_m = tracker.fix()->T_map_robot.position_m();
    tracker.perceive(sonars());
    return tracker.fix()->T_map_robot.position_m() - before_m;
  }

  /// The navigator's pose values after each step of a short drive.
  std::vector<double> drive(const std::string& settings);

  const world::World world = floor_with_column();
  const planning::HybridMap map = map_of_walls(world);
  const support::TemporaryFolder folder{"topogeo_markov_settings"};
  simulation::RobotOptions options;
  std::optional<simulation::SimulatedRobot> robot;
  std::int64_t stamp_ns = 0;
};

std::vector<double> MarkovSettings::drive(const std::string& settings) {
  constexpr std::int64_t kStep_ns = 1'000'000'000;
  const navigation::NavigatorConfig config = load(settings);
  navigation::PoseSources poses(config);
  poses.set_map(&map);
  std::vector<double> trace;
  const auto step = [&](const simulation::Velocity& motion, bool done) {
    robot->step(motion, 1.0);
    stamp_ns += kStep_ns;
    poses.add(navigation::OdometrySample{stamp_ns, robot->T_odom_robot()});
    poses.add(scan());
    poses.add(sonars());
    poses.update(done, stamp_ns);
    const auto& fix = poses.markov_pose();
    if (!fix) return;
    const geometry::Pose2& pose = fix->T_map_robot;
    const Eigen::Vector3d variances = fix->covariance.diagonal();
    trace.insert(trace.end(), {pose.x_m, pose.y_m, pose.theta_rad, variances[0], variances[1],
                               variances[2], fix->tracking ? 1.0 : 0.0});
  };
  const auto primitive = [&](const simulation::Velocity& part, int parts) {
    for (int i = 1; i <= parts; ++i) step(part, i == parts);
  };
  step({0.0, 0.0}, false);
  primitive({0.1, 0.0}, 15);
  primitive({0.0, 0.1 * kQuarter_rad}, 10);
  primitive({0.1, 0.0}, 20);
  primitive({0.0, -0.1 * kQuarter_rad}, 5);
  poses.must_stand(true, std::nullopt, stamp_ns);
  for (int i = 0; i < 6; ++i) step({0.0, 0.0}, false);
  return trace;
}

// Another value of a key, and the other settings that it needs to have an effect.
struct OtherValue {
  std::string value;
  std::string besides;
};

TEST_F(MarkovSettings, EachKeyOfTheSectionReachesThePoseOfTheNavigator) {
  const std::string positions = "grid: positions";
  const std::map<std::string, OtherValue> others = {
      {"by_laser", {"true", ""}},
      {"grid", {"positions", ""}},
      {"cell_m", {"0.2", ""}},
      {"heading_sigma_rad", {"0.1", positions}},
      {"station", {"dock", ""}},
      {"station_heading_rad", {"0.1", "station: shelf"}},
      {"window_cells", {"5", positions}},
      {"perceptual_weight", {"1", positions}},
      {"advance_matrix", {"\"0 0.5 0.5\"", positions}},
      {"left_matrix", {"\"0.5; 0.5; 0\"", positions}},
      {"right_matrix", {"\"0.5; 0.5; 0\"", positions}},
      {"arrow_sense", {"left", positions}},
      {"advance_step_m", {"0.5", positions}},
      {"turn_step_rad", {"0.2", positions}},
      {"max_range_m", {"2.5", "reliability_bands: 2.5 1"}},
      {"scale_m", {"0.5", positions}},
      {"formula", {"linear", positions}},
      {"reliability_bands", {"\"1 1; 5 0.1\"", positions}},
      {"weigh_by_reliability", {"true", positions}},
      {"station_sigma_m", {"0.2", ""}},
      {"station_sigma_rad", {"0.2", ""}},
      {"path_sigma_m", {"0.2", ""}},
      {"path_sigma_rad", {"0.1", ""}},
      {"turn_sigma_rad", {"0.3", ""}},
      {"turn_sigma_m", {"0.1", ""}},
      {"perceive_every_m", {"0.5", ""}},
      {"perceive_every_rad", {"0.5", ""}},
      {"hit_sigma_m", {"0.2", ""}},
      {"far_from_m", {"1", ""}},
      {"evidence", {"1", ""}},
      {"least_agreement", {"0.9", "station: shelf, station_heading_rad: 1"}},
  };
  const auto trace_of = [&](const std::string& settings) {
    put_at_start();
    return drive(settings);
  };
  std::map<std::string, std::vector<double>> plain;
  Config config;
  const support::ConfigSchema schema = describe(config);
  for (const support::ConfigParameter& parameter : schema.parameters()) {
    if (parameter.fixed || !parameter.key.starts_with("markov.")) continue;
    const std::string key = parameter.key.substr(7);
    const auto found = others.find(key);
    ASSERT_NE(found, others.end()) << key << " has no value here";
    const auto& [value, besides] = found->second;
    if (!plain.contains(besides)) plain[besides] = trace_of(besides);
    EXPECT_GT(plain[besides].size(), 300U) << besides;
    std::string settings = besides.empty() ? "" : besides + ", ";
    settings += key;
    settings += ": ";
    settings += value;
    EXPECT_NE(trace_of(settings), plain[besides]) << settings;
  }
}

// An advance of 0.5 m with a matrix that always moves a cell (0.1 m) too far.
TEST_F(MarkovSettings, TheMatrixOfAnAdvanceTakesThePoseAheadOrBehind) {
  const std::string far = "grid: positions, perceptual_weight: 0, advance_matrix: \"0 0 1\"";
  const auto after_advance = [&](const std::string& more) {
    put_at_start();
    return moved_by_look_m(far + more, {{0.5, 0.0}});
  };
  // Odometry has 0.475 m: four steps, and three quarters of one.
  EXPECT_NEAR(after_advance("").x(), 0.5, 1e-9);
  EXPECT_NEAR(after_advance(", arrow_sense: left").x(), -0.5, 1e-9);
  EXPECT_NEAR(after_advance(", advance_step_m: 0.25").x(), 0.2, 1e-9);
  EXPECT_NEAR(after_advance(", advance_step_m: 0").x(), 0.1, 1e-9);
}

// A turn with a matrix that always shifts a cell to the left; the other matrix is not used.
TEST_F(MarkovSettings, TheMatricesOfTurnsAreThoseOfTheirTurns) {
  const auto after_turn = [&](const std::string& matrix, double angle_rad) {
    put_at_start();
    return moved_by_look_m("grid: positions, perceptual_weight: 0, " + matrix, {{0.0, angle_rad}});
  };
  const std::string to_the_left = "_matrix: \"1; 0; 0\"";
  EXPECT_NEAR(after_turn("left" + to_the_left, kQuarter_rad).y(), 0.1, 1e-9);
  EXPECT_NEAR(after_turn("left" + to_the_left, -kQuarter_rad).y(), 0.0, 1e-9);
  EXPECT_NEAR(after_turn("right" + to_the_left, -kQuarter_rad).y(), 0.1, 1e-9);
  EXPECT_NEAR(after_turn("right" + to_the_left, kQuarter_rad).y(), 0.0, 1e-9);
  EXPECT_NEAR(after_turn("turn_step_rad: 0.785, left" + to_the_left, kQuarter_rad).y(), 0.2, 1e-9);
}

// Odometry is 0.1 m short after 2 m. The motion model does not know that, so readings decide by
// their weight.
TEST_F(MarkovSettings, BandsDecideHowMuchReadingsCount) {
  const auto after_drive_m = [&](const std::string& bands) {
    put_at_start();
    return moved_by_look_m(
               "grid: positions, perceptual_weight: 1, advance_matrix: \"1\", "
               "reliability_bands: \"" +
                   bands + "\"",
               {{2.0, 0.0}})
        .x();
  };
  constexpr double kCell_m = 0.1;
  EXPECT_NEAR(after_drive_m("5 1"), 0.1, kCell_m - 1e-9);
  EXPECT_NEAR(after_drive_m("5 0.1"), 0.0, 1e-9);
  EXPECT_NEAR(after_drive_m("5 0"), 0.0, 1e-9);
  EXPECT_NEAR(after_drive_m("0.05 1"), 0.0, 1e-9);  // all surfaces are farther than that
}

TEST_F(MarkovSettings, WhatDoesNotFitIsRefusedWithTheKey) {
  const auto complaint = [&](const std::string& settings) -> std::string {
    try {
      load(settings);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  using testing::HasSubstr;
  EXPECT_THAT(complaint("advance_matrix: \"0 1\""),
              HasSubstr("key 'markov.advance_matrix' = '2': expected an odd number of columns"));
  EXPECT_THAT(complaint("left_matrix: \"0 1 0; 1\""),
              HasSubstr("key 'markov.left_matrix' = \"0 1 0; 1\": expected rows"));
  EXPECT_THAT(complaint("right_matrix: \"0 2 0\""),
              HasSubstr("key 'markov.right_matrix' = '2': expected number between 0 and 1.01"));
  EXPECT_THAT(complaint("right_matrix: \"0 0.05 0\""), HasSubstr("expected a sum"));
  EXPECT_THAT(complaint("reliability_bands: \"2.5\""),
              HasSubstr("key 'markov.reliability_bands' = \"2.5\": expected pairs"));
  EXPECT_THAT(complaint("reliability_bands: \"2.5 1; 2 0.5\""),
              HasSubstr("key 'markov.reliability_bands' = '2': expected number between 2.5"));
  EXPECT_THAT(
      complaint("max_range_m: 3"),
      HasSubstr("key 'markov.reliability_bands' = '5': expected number between 2.5 and 3 m"));
  EXPECT_EQ(complaint("max_range_m: 3, reliability_bands: \"3 1\""), "");
}

}  // namespace
}  // namespace topogeo::pipeline
