#include "topogeo/pipeline/config.hpp"

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

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

  /// The error of load_config for a file with this content; empty if it accepts it.
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

TEST_F(ConfigTest, KnowsWhatTheFileSets) {
  const auto load = [this](const std::string& yaml) {
    std::ofstream(file_) << yaml;
    return load_config(file_);
  };
  EXPECT_FALSE(load_config({}).stop_distance_set);
  EXPECT_FALSE(load_config({}).odometry_noise_set);
  EXPECT_FALSE(load_config({}).range_scale_set);
  EXPECT_TRUE(load("scan: {range_scale: 1}\n").range_scale_set);
  EXPECT_TRUE(load("stop: {distance_m: 1.0}\n").stop_distance_set) << "the default, but set";
  EXPECT_FALSE(load("stop: {distance_m: 1.0}\n").odometry_noise_set);
  EXPECT_TRUE(load("odometry.heading_rad2_per_m: 0.01\n").odometry_noise_set);
  EXPECT_FALSE(load("odometry.heading_rad2_per_m: 0.01\n").stop_distance_set);
}

TEST_F(ConfigTest, ChangedValuesReachAllThatUseThem) {
  LoadedConfig loaded = load_config({});
  localization::OdometryNoise noise = loaded.config.localizer.odometry;
  noise.heading_rad2_per_m *= 0.5;
  const std::uint64_t before = loaded.effective.fingerprint;
  set_odometry_noise(loaded, noise);
  EXPECT_EQ(loaded.config.local_mapper.tracker.odometry.heading_rad2_per_m,
            noise.heading_rad2_per_m);
  EXPECT_EQ(loaded.config.calibration.fallback.heading_rad2_per_m, noise.heading_rad2_per_m);
  EXPECT_NE(loaded.effective.fingerprint, before);
  set_stop_distance(loaded, 0.5);
  EXPECT_EQ(loaded.config.local_mapper.stop_distance_m, 0.5);
}

// The part of a page between two lines.
std::string part_of(const std::filesystem::path& page, const std::string& from,
                    const std::string& to) {
  std::ifstream file(page);
  std::ostringstream text;
  text << file.rdbuf();
  const std::string all = text.str();
  const std::size_t begin = all.find(from + "\n");
  const std::size_t end = all.find(to + "\n");
  if (begin == std::string::npos || end == std::string::npos) return "no " + from;
  const std::size_t first = begin + from.size() + 1;
  return all.substr(first, end - first);
}

// The blocks of a page that are indented by four blanks, without the indent.
std::vector<std::string> indented_blocks(const std::filesystem::path& page) {
  std::ifstream file(page);
  std::vector<std::string> blocks;
  bool inside = false;
  for (std::string line; std::getline(file, line); inside = line.starts_with("    ")) {
    if (!line.starts_with("    ")) continue;
    if (!inside) blocks.emplace_back();
    blocks.back() += line.substr(4) + "\n";
  }
  return blocks;
}

// The libraries that declare each key.
std::map<std::string, std::set<std::string>> owners_of_keys(Config& c) {
  std::map<std::string, std::set<std::string>> owners;
  const auto library = [&](const std::string& name, auto&... configs) {
    support::ConfigSchema schema;
    (describe(configs, schema), ...);
    for (const support::ConfigParameter& p : schema.parameters()) owners[p.key].insert(name);
  };
  library("scan", c.log);
  library("voronoi", c.local_mapper.voronoi);
  library("topomap", c.local_mapper.local_map, c.global_map);
  library("localization", c.local_mapper.tracker, c.localizer, c.calibration);
  library("planning", c.planner, c.planning, c.hybrid_map.grid, c.hybrid_map.inflation,
          c.hybrid_map.zones, c.hybrid_planner, c.navigator.smooth, c.navigator.detour);
  library("markov", c.navigator.markov.markov);
  library("markov poses", c.navigator.markov.poses);
  library("navigation", c.navigator, c.exploration);
  library("pipeline", c.odometry_source, c.local_mapper, c.metrics, c.report);
  return owners;
}

TEST_F(ConfigTest, EveryKeyIsDeclaredByOneLibrary) {
  Config config;
  const auto owners = owners_of_keys(config);
  const support::ConfigSchema schema = describe(config);
  for (const support::ConfigParameter& parameter : schema.parameters()) {
    const auto found = owners.find(parameter.key);
    ASSERT_NE(found, owners.end()) << parameter.key;
    EXPECT_EQ(found->second.size(), 1U) << parameter.key;
  }
  EXPECT_EQ(owners.size(), schema.parameters().size());
}

TEST_F(ConfigTest, WhereFiguresAreGivenDoesNotTurnWorkersAway) {
  Config config;
  const support::EffectiveConfig before = support::effective(describe(config));
  config.metrics.port = 9464;
  const support::EffectiveConfig with_port = support::effective(describe(config));
  EXPECT_EQ(with_port.fingerprint, before.fingerprint);
  EXPECT_NE(with_port.values, before.values);
  config.localizer.seed += 1;
  EXPECT_NE(support::effective(describe(config)).fingerprint, before.fingerprint);
}

TEST_F(ConfigTest, TheTablesOfTheDocumentationAreThoseOfTheDeclarations) {
  Config config;
  if (config.localizer.added_mode.get() == nullptr) {
    GTEST_SKIP() << "the pages describe programs with research/ (TOPOGEO_RESEARCH)";
  }
  std::ostringstream tables;
  support::write_markdown(describe(config), tables);
  EXPECT_EQ(part_of(std::filesystem::path(TOPOGEO_SOURCE_DIR) / "docs/configuration.md",
                    "<!-- begin of `topogeo config --markdown` -->", "<!-- end of it -->"),
            tables.str())
      << "write them anew: build/bin/topogeo config --markdown";
}

TEST_F(ConfigTest, EveryConfigurationOfTheDocumentationIsAccepted) {
  Config config;
  const support::ConfigSchema schema = describe(config);
  std::size_t examples = 0;
  for (const auto& page :
       std::filesystem::directory_iterator(std::filesystem::path(TOPOGEO_SOURCE_DIR) / "docs")) {
    if (page.path().extension() != ".md") continue;
    for (const std::string& block : indented_blocks(page)) {
      const std::string first = block.substr(0, block.find(":\n"));
      if (!schema.is_section(first)) continue;
      if (block.find("\n  port:") != std::string::npos) continue;  // of a devices file
      ++examples;
      EXPECT_EQ(complaint(block), "") << page.path();
    }
  }
  EXPECT_GE(examples, 1U);
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
  EXPECT_THAT(even, HasSubstr("key 'markov.window_cells' = '20': expected an odd number"));
  EXPECT_THAT(
      complaint("navigator:\n  min_radius_m: 3\n  max_radius_m: 2\n"),
      HasSubstr("'navigator.max_radius_m' = '2': expected at least navigator.min_radius_m = 3"));
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

TEST_F(ConfigTest, AnOutlineSizesTheForbiddenCells) {
  std::ofstream(file_)
      << "robot:\n  footprint: [[0.6, 0.4], [0.6, -0.4], [-0.6, -0.4], [-0.6, 0.4]]\n";
  const Config config = load_config(file_).config;
  EXPECT_EQ(config.navigator.guard.footprint.corners_m.size(), 4U);
  EXPECT_NEAR(config.hybrid_map.inflation.forbidden_cells, 4.0, 1e-9);
  EXPECT_NEAR(config.planning.min_clearance_m, 0.42, 1e-9);
  EXPECT_TRUE(load_config({}).config.navigator.guard.footprint.empty());
  EXPECT_EQ(load_config({}).config.hybrid_map.inflation.forbidden_cells, 3.0);
  std::ofstream(file_) << "base: {minimum_turning_radius_m: 0.8}\n";
  EXPECT_EQ(load_config(file_).config.navigator.guard.minimum_turning_radius_m, 0.8);
  EXPECT_THAT(complaint("base: {minimum_turning_radius_m: -1}"),
              HasSubstr("base.minimum_turning_radius_m"));
  EXPECT_THAT(complaint("{base: {minimum_turning_radius_m: 1}, navigator: {motion: primitives}}"),
              HasSubstr("turn on the spot"));
  EXPECT_THAT(complaint("robot: {footprint: [[1.6, 0.4], [1.6, -0.4], [0.6, 0]]}"),
              HasSubstr("origin"));
  EXPECT_THAT(complaint("robot: {footprint: [[0.6, 0.4], [0.6, -0.4, 1]]}"),
              HasSubstr("robot.footprint"));
}

}  // namespace
}  // namespace topogeo::pipeline
