// topogeo run --sim: services, gateway and emulated devices on pseudo-terminals, in real time.
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "topogeo/storage/tum.hpp"

#include "program.hpp"
#include "simulated_drive.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class SimulationTest : public testing::Test {
 protected:
  SimulationTest() { use_udp_only(); }

  std::vector<std::string> words(const std::string& world) {
    return {"run", "--sim",    world,        "--out",   out_, "--workers",
            "0",   "--domain", own_domain(), "--speed", "0.6"};
  }

  /// Displacement from start to end, in the frame of the start.
  static Eigen::Vector2d way(const std::vector<topomap::StampedPose>& poses) {
    return geometry::between(poses.front().pose, poses.back().pose).position_m();
  }

  /// Distance driven from start to end.
  static double distance_m(const std::vector<topomap::StampedPose>& poses) {
    double sum_m = 0.0;
    for (std::size_t i = 1; i < poses.size(); ++i) {
      sum_m += (poses[i].pose.position_m() - poses[i - 1].pose.position_m()).norm();
    }
    return sum_m;
  }

  Scratch scratch_;
  std::string out_ = scratch_ / "out";
};

class EachSimulatedLaser : public SimulationTest,
                           public testing::WithParamInterface<std::string> {};

class EachSimulatedBase : public SimulationTest, public testing::WithParamInterface<std::string> {};

TEST_P(EachSimulatedBase, DrivesTheTourThroughSerialPortsAndMapsIt) {
  std::vector<std::string> arguments =
      words(std::string(TOPOGEO_SHARE) + "/worlds/short.world.yaml");
  arguments.insert(arguments.end(), {"--base-model", GetParam(), "--laser-model", "ld19"});
  Program run(scratch_, "topogeo", arguments);
  ASSERT_EQ(run.wait(), 0) << run.err();
  EXPECT_THAT(run.out(), Not(HasSubstr("collisions")));
  const auto truth = storage::read_trajectory_tum(out_ + "/truth.tum");
  const auto found = storage::read_trajectory_tum(out_ + "/trajectory.tum");
  ASSERT_GT(truth.size(), 20U);
  EXPECT_LT((truth.back().pose.position_m() - Eigen::Vector2d(6.2, 3.0)).norm(), 0.3);
  EXPECT_LT((way(truth) - way(found)).norm(), 0.2);
}

INSTANTIATE_TEST_SUITE_P(OneOfEachOtherFamily, EachSimulatedBase,
                         testing::Values("microcontroller", "create2", "kobuki", "pioneer",
                                         "roboteq", "vesc"),
                         [](const auto& base) { return base.param; });

TEST_P(EachSimulatedLaser, DrivesTheTourThroughSerialPortsAndMapsIt) {
  std::vector<std::string> arguments =
      words(std::string(TOPOGEO_SHARE) + "/worlds/short.world.yaml");
  arguments.insert(arguments.end(), {"--laser-model", GetParam()});
  Program run(scratch_, "topogeo", arguments);
  ASSERT_EQ(run.wait(), 0) << run.err();
  EXPECT_THAT(run.out(), HasSubstr("corrected"));
  EXPECT_THAT(run.out(), Not(HasSubstr("collisions")));
  const auto truth = storage::read_trajectory_tum(out_ + "/truth.tum");
  const auto found = storage::read_trajectory_tum(out_ + "/trajectory.tum");
  ASSERT_GT(truth.size(), 20U);
  ASSERT_LE(truth.size(), found.size());
  EXPECT_LT((truth.back().pose.position_m() - Eigen::Vector2d(6.2, 3.0)).norm(), 0.3);
  EXPECT_LT((way(truth) - way(found)).norm(), 0.2);
  EXPECT_TRUE(std::filesystem::exists(out_ + "/map.pb"));
  EXPECT_FALSE(std::filesystem::is_symlink(out_ + "/laser.port"));
  EXPECT_FALSE(std::filesystem::is_symlink(out_ + "/base.port"));
}

INSTANTIATE_TEST_SUITE_P(OneOfEachFamily, EachSimulatedLaser,
                         testing::Values("sick_pls", "ld19", "ld08", "lds01", "xv11", "rplidar_a1",
                                         "ydlidar_x2", "ydlidar_tg", "ust_20lx", "sick_tim7xx"),
                         [](const auto& laser) { return laser.param; });

// Each service is killed in turn while the robot drives. The robot drives on until it has driven
// 1.5 m with the service at work again, however long the restart takes.
TEST_F(SimulationTest, TheMapEndsCompleteAndRightAfterEachServiceWasKilled) {
  constexpr double kFurther_m = 1.5;
  Program run(scratch_, "topogeo", words(write_world_of_rounds(scratch_)));
  DriveWatch drive;
  ASSERT_TRUE(drive.wait_for_local_maps(run, 2)) << run.err();
  const std::vector<std::string> names = {"sensor_gateway", "local_mapper", "localizer",
                                          "map_store"};
  for (const std::string& name : names) {
    SCOPED_TRACE(name);
    const std::vector<pid_t> service = run.services(name);
    ASSERT_EQ(service.size(), 1U);
    ::kill(service[0], SIGKILL);
    run.wait_for_error_text(name + " is at work again after");
    ASSERT_TRUE(drive.wait_for_distance(run, kFurther_m)) << run.err();
    EXPECT_THAT(run.err(), HasSubstr(name + " was killed by signal 9"));
  }
  run.send_signal(SIGINT);
  ASSERT_EQ(run.wait(), 0) << run.err();
  EXPECT_THAT(run.err(), HasSubstr("started again"));
  print_lines_with(" is at work again after", run.err());
  EXPECT_THAT(read_file(out_ + "/logs/sensor_gateway-2.log"), HasSubstr("the odometry goes on"));
  EXPECT_THAT(read_file(out_ + "/logs/local_mapper-2.log"), Not(HasSubstr("expected 0")))
      << "no scan is missing to who joins a laser that runs";
  const auto truth = storage::read_trajectory_tum(out_ + "/truth.tum");
  const auto found = storage::read_trajectory_tum(out_ + "/trajectory.tum");
  EXPECT_GT(distance_m(truth), static_cast<double>(names.size()) * kFurther_m)
      << "what was driven after the restarts is in the map";
  EXPECT_LT((way(truth) - way(found)).norm(), 0.2) << "one map from the first scan to the last";
}

TEST_F(SimulationTest, CtrlCEndsTheDriveWithAMap) {
  Program run(scratch_, "topogeo", words(write_world_of_rounds(scratch_)));
  ASSERT_TRUE(DriveWatch().wait_for_local_maps(run, 2)) << run.err();
  run.send_signal(SIGINT);
  EXPECT_EQ(run.wait(), 0) << run.err();
  EXPECT_TRUE(std::filesystem::exists(out_ + "/map.pb"));
  EXPECT_THAT(run.services(), IsEmpty());
}

TEST_F(SimulationTest, AWorldThatCannotBeDrivenIsNamedBeforeAnythingStarts) {
  Program none(scratch_, "topogeo", words(scratch_ / "none.yaml"));
  EXPECT_EQ(none.wait(), 3);
  EXPECT_THAT(none.err(), HasSubstr("none.yaml"));
  EXPECT_FALSE(std::filesystem::exists(out_ + "/logs"));
}

}  // namespace
}  // namespace topogeo::test
