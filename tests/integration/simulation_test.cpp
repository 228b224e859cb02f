// topogeo run --sim: services, gateway and emulated devices on pseudo-terminals, in real time.
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "topogeo/storage/tum.hpp"

#include "program.hpp"

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

  Scratch scratch_;
  std::string out_ = scratch_ / "out";
};

TEST_F(SimulationTest, DrivesTheTourThroughSerialPortsAndMapsIt) {
  Program run(scratch_, "topogeo", words(std::string(TOPOGEO_TEST_DATA) + "/short.world.yaml"));
  ASSERT_EQ(run.wait(), 0) << run.err();
  EXPECT_THAT(run.out(), HasSubstr("corrected"));
  EXPECT_THAT(run.out(), Not(HasSubstr("collisions")));
  const auto truth = storage::read_trajectory_tum(out_ + "/truth.tum");
  const auto found = storage::read_trajectory_tum(out_ + "/trajectory.tum");
  ASSERT_GT(truth.size(), 20U);
  ASSERT_LE(truth.size(), found.size());
  EXPECT_LT((truth.back().pose.position_m() - Eigen::Vector2d(6.2, 3.0)).norm(), 0.3);
  // Seen from its start, the estimated pose is the true one.
  const auto way = [](const auto& poses) {
    return geometry::between(poses.front().pose, poses.back().pose).position_m();
  };
  EXPECT_LT((way(truth) - way(found)).norm(), 0.2);
  EXPECT_TRUE(std::filesystem::exists(out_ + "/map.pb"));
  EXPECT_FALSE(std::filesystem::is_symlink(out_ + "/laser.port"));
  EXPECT_FALSE(std::filesystem::is_symlink(out_ + "/base.port"));
}

TEST_F(SimulationTest, CtrlCEndsTheDriveWithAMap) {
  Program run(scratch_, "topogeo", words(std::string(TOPOGEO_TEST_DATA) + "/short.world.yaml"));
  run.wait_for_progress(10);
  run.send_signal(SIGINT);
  EXPECT_EQ(run.wait(), 0) << run.err();
  EXPECT_TRUE(std::filesystem::exists(out_ + "/map.pb"));
  EXPECT_THAT(run.services(), IsEmpty());
}

TEST_F(SimulationTest, AWorldThatCannotBeDrivenIsNamedBeforeAnythingStarts) {
  Program none(scratch_, "topogeo", words(scratch_ / "none.yaml"));
  EXPECT_EQ(none.wait(30), 3);
  EXPECT_THAT(none.err(), HasSubstr("none.yaml"));
  EXPECT_FALSE(std::filesystem::exists(out_ + "/logs"));
}

}  // namespace
}  // namespace topogeo::test
