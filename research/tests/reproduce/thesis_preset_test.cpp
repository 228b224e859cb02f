// The preset of the Thesis (share/thesis/thesis.config.yaml) closes the loop of experiment 2 by
// nodes and branches alone.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "topogeo/thesis/thesis_mode.hpp"

#include "reproduce/shared_runs.hpp"
#include "reproduce/worlds.hpp"

namespace topogeo::reproduce {
namespace {

TEST(ThesisPreset, UsesNeitherScanPointsNorGate) {
  const pipeline::Config config = thesis_preset();
  EXPECT_EQ(config.local_mapper.voronoi.range_limit_m, 4.0);
  EXPECT_EQ(config.localizer.mode, localization::SlamAlgorithm::kThesis);
  EXPECT_EQ(config.localizer.evidence, localization::MatchEvidence::kFitness);
  EXPECT_EQ(config.localizer.fitness_form, localization::FitnessForm::kTopological);
  EXPECT_EQ(config.localizer.genetic.individuals, 100U);
  EXPECT_EQ(config.localizer.genetic.generations, 50U);
  EXPECT_GT(localization::thesis_config(config.localizer).thesis.kept_solutions, 1U);
}

class PresetDrive : public testing::TestWithParam<std::uint64_t> {};

TEST_P(PresetDrive, ClosesTheLoop) {
  const Drive drive = loop_drive(GetParam());
  const Correction correction = correct_loop(drive);
  const geometry::Pose2& truth = drive.truth.back();
  const Eigen::Vector3d off = geometry::difference(correction.final_poses().back(), truth);
  EXPECT_LE(off.head<2>().norm(), 0.5);
  EXPECT_LE(std::fabs(off.z()) * 180.0 / std::numbers::pi, 1.0);
  // Forward correction and odometry do not close it.
  const auto off_m = [&](const geometry::Pose2& pose) {
    return (pose.position_m() - truth.position_m()).norm();
  };
  EXPECT_GT(off_m(correction.map().poses().back()), 2.0);
  EXPECT_GT(off_m(drive.odometry.back()), 5.0);
}

INSTANTIATE_TEST_SUITE_P(Seeds, PresetDrive, testing::Values(1, 2, 3));

}  // namespace
}  // namespace topogeo::reproduce
