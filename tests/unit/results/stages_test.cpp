#include "topogeo/results/stages.hpp"

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::results {
namespace {

struct Drive {
  pipeline::Config config;
  simulation::SimulatedLog log;
  storage::MapDocument document;
};

Drive drive(localization::SlamAlgorithm mode) {
  Drive drive;
  drive.config = pipeline::load_config({}).config;
  drive.config.localizer.mode = mode;
  drive.log = simulation::simulate_log(
      world::load_world(std::filesystem::path(TOPOGEO_SHARE) / "worlds/room.world.yaml"), {});
  pipeline::MappingRun run(drive.config, "robot");
  for (const scan::Scan& scan : drive.log.scans) run.add(scan);
  drive.document = run.finish();
  return drive;
}

double end_error_m(const Drive& drive, const topomap::Trajectory& trajectory) {
  const geometry::Pose2 truth =
      geometry::between(drive.log.T_world_robot[drive.document.local_maps.front().sequence],
                        drive.log.T_world_robot[drive.document.local_maps.back().sequence]);
  return (trajectory.stops.back().T_map_robot.position_m() - truth.position_m()).norm();
}

class StagesTest : public testing::TestWithParam<localization::SlamAlgorithm> {};

TEST_P(StagesTest, GoFromOdometryToTheFinalMap) {
  const Drive driven = drive(GetParam());
  const std::vector<CorrectionStage> stages = correction_stages(driven.config, driven.document);
  ASSERT_EQ(stages.size(), 4U);
  for (const CorrectionStage& stage : stages) {
    ASSERT_EQ(stage.trajectory.stops.size(), driven.document.local_maps.size()) << stage.name;
    EXPECT_EQ(stage.trajectory.stops.front().T_map_robot, geometry::Pose2{}) << stage.name;
  }
  EXPECT_TRUE(stages[0].loop_closures.empty());
  EXPECT_TRUE(stages[1].loop_closures.empty());
  EXPECT_EQ(stages[3].loop_closures.size(), driven.document.loop_closures.size());
  EXPECT_LT(end_error_m(driven, stages[1].trajectory), end_error_m(driven, stages[0].trajectory));
  EXPECT_LT(end_error_m(driven, stages[3].trajectory), 0.2);
}

// The modes that the program has.
std::vector<localization::SlamAlgorithm> modes() {
  using localization::SlamAlgorithm;
  const bool added = localization::LocalizerConfig().added_mode.get() != nullptr;
  return added ? std::vector{SlamAlgorithm::kGraph, SlamAlgorithm::kThesis}
               : std::vector{SlamAlgorithm::kGraph};
}

INSTANTIATE_TEST_SUITE_P(Modes, StagesTest, testing::ValuesIn(modes()), [](const auto& mode) {
  return mode.param == localization::SlamAlgorithm::kGraph ? "Graph" : "Thesis";
});

TEST(StagePictures, AreFourFiles) {
  const Drive driven = drive(localization::SlamAlgorithm::kGraph);
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "topogeo_stage_pictures";
  std::filesystem::create_directories(folder);
  write_stage_pictures(folder, driven.config, driven.document, "room");
  for (const char* name : {"1_odometry", "2_forward", "3_backward", "4_final"}) {
    EXPECT_GT(std::filesystem::file_size(folder / ("stage_" + std::string(name) + ".png")), 1000U);
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace topogeo::results
