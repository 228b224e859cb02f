// topogeo run --sim --goto: all services on emulated devices, sent to a place of a stored map.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/planning.h"
#include "topogeo/service/conversions.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/support/host.hpp"

#include "join.hpp"
#include "program.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Writes map/map.pb from a drive through one of the test worlds.
void map_world(const Scratch& scratch, const std::string& world) {
  write_log(world, scratch / "drive.clf");
  Program map(scratch, "topogeo",
              {"map", "--log", scratch / "drive.clf", "--out", scratch / "map"});
  ASSERT_EQ(map.wait(), 0) << map.err();
}

TEST(Goto, ASimulatedRobotIsSentToAPointOfAStoredMap) {
  use_udp_only();
  const Scratch scratch;
  ASSERT_NO_FATAL_FAILURE(map_world(scratch, "room"));
  const std::string out = scratch / "out";
  // The map's origin is the start of the tour, at (1, 1); the robot heads along the wall.
  Program run(scratch, "topogeo",
              {"run", "--sim", std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml", "--map",
               scratch / "map/map.pb", "--goto", "3,0", "--patience", "600", "--heading", "90",
               "--out", out, "--workers", "0", "--domain", own_domain()});
  ASSERT_EQ(run.wait(), 0) << run.err();
  EXPECT_THAT(run.out(), HasSubstr("arrived at 3,0"));
  EXPECT_THAT(run.out(), HasSubstr(" 0 collisions"));
  EXPECT_TRUE(std::filesystem::exists(out + "/route.png"));
  const auto truth = storage::read_trajectory_tum(out + "/truth.tum");
  ASSERT_FALSE(truth.empty());
  EXPECT_LT((truth.back().pose.position_m() - Eigen::Vector2d(3.0, 0.0)).norm(), 0.3);
  EXPECT_FALSE(std::filesystem::is_symlink(out + "/base.port"));
}

/// Follows the navigator of the test's domain, and pauses it.
class NavigatorWatch {
 public:
  /// Waits until the robot drives to its goal. False when `run` has ended before.
  [[nodiscard]] bool wait_for_drive(Program& run) {
    return wait_unless_ended(run,
                             [&] { return status_ && status_->state() == msg::kNavigatorDriving; });
  }
  /// Waits until the robot has driven so much further. False when `run` has ended before.
  [[nodiscard]] bool wait_for_distance(Program& run, double further_m) {
    const double least_m = driven_m_ + further_m;
    return wait_unless_ended(run, [&] { return status_ && driven_m_ >= least_m; });
  }

  /// Pauses the drive or resumes it, unless `run` ends before.
  [[nodiscard]] bool set_paused(Program& run, bool paused) {
    const auto is_done = [&] {
      receive();
      return run.ended() || (status_ && (status_->reason() == msg::kHaltPaused) == paused);
    };
    // A navigator that is being restarted gets no order, so one follows each status.
    return wait_for(paused ? "the robot to pause" : "the robot to resume", is_done, [&] {
      send(paused ? msg::kGoalPause : msg::kGoalResume);
      static_cast<void>(statuses_.wait_for_data(std::chrono::seconds(1)));
    });
  }

 private:
  template <class Condition>
  [[nodiscard]] bool wait_unless_ended(Program& run, const Condition& condition) {
    const bool there = wait_for("the robot to drive", [&] {
      receive();
      return condition() || run.ended();
    });
    return there && condition();
  }
  void receive() {
    statuses_.take([this](const msg::NavigatorStatus& status, const messaging::SampleInfo& info) {
      if (!info.valid) return;
      // A navigator that was started again counts from zero.
      const double before_m = status_ ? status_->driven_m() : 0.0;
      driven_m_ += status.driven_m() - (status.driven_m() < before_m ? 0.0 : before_m);
      status_ = status;
    });
  }
  void send(msg::GoalKind kind) {
    service::Goal order;
    order.client_id = "test";
    order.kind = kind;
    static_cast<void>(
        goals_.write(service::to_msg(order, "robot", support::wall_clock_ns(), sent_++)));
  }

  messaging::Participant participant_ = join(own_domain(), messaging::kAnyPartition);
  messaging::Reader<msg::NavigatorStatus> statuses_{participant_};
  messaging::Writer<msg::Goal> goals_{participant_};
  std::optional<msg::NavigatorStatus> status_;
  double driven_m_ = 0.0;
  std::uint64_t sent_ = 0;
};

/// A drive in a finished map whose services are killed. One scan of this floor does not determine
/// the pose: after a search of the whole map the robot would stand forever.
class GotoLives : public testing::Test {
 protected:
  /// Services that are killed together.
  using Services = std::vector<std::string>;

  /// Drives to the goal. Kills each group of services while the robot drives, and takes the group
  /// from `groups` when all of them are back.
  void drive_and_kill(std::deque<Services>& groups) {
    run_ = std::make_unique<Program>(
        scratch_, "topogeo",
        std::vector<std::string>{
            "run", "--sim", std::string(TOPOGEO_SHARE) + "/worlds/floor.world.yaml", "--map",
            scratch_ / "map/map.pb", "--goto", "8,0", "--patience", "600", "--out",
            scratch_ / "out", "--workers", "0", "--domain", own_domain()});
    NavigatorWatch navigator;
    run_->wait_for_error_text("driving [");
    while (!groups.empty() && navigator.wait_for_drive(*run_)) {
      read_ = run_->err().size();
      if (!kill_services(groups.front())) break;
      ASSERT_NO_FATAL_FAILURE(drive_until_all_are_back(groups.front(), navigator));
      if (are_at_work_again(groups.front())) groups.pop_front();
    }
    EXPECT_EQ(run_->wait(), 0) << run_->err();
    print_lines_with(" is at work again after", run_->err());
  }

  Scratch scratch_;
  std::unique_ptr<Program> run_;

 private:
  /// Since the last kill.
  [[nodiscard]] bool are_at_work_again(const Services& services) const {
    const std::string err = run_->err();
    return std::ranges::all_of(services, [&](const std::string& name) {
      return err.find(name + " is at work again after", read_) != std::string::npos;
    });
  }
  /// False when the robot was about to arrive.
  [[nodiscard]] bool kill_services(const Services& services) const {
    return std::ranges::all_of(services, [&](const std::string& name) {
      const std::vector<pid_t> service = run_->services(name);
      return service.size() == 1 && ::kill(service[0], SIGKILL) == 0;
    });
  }
  /// The robot drives on without some services, and stops on its way until they are back.
  void drive_until_all_are_back(const Services& services, NavigatorWatch& navigator) {
    constexpr double kFurther_m = 0.5;
    if (!navigator.wait_for_distance(*run_, kFurther_m) || are_at_work_again(services)) return;
    ASSERT_TRUE(navigator.set_paused(*run_, true)) << run_->err();
    ASSERT_TRUE(wait_for("services at work again", [&] {
      return are_at_work_again(services) || run_->ended();
    })) << run_->err();
    ASSERT_TRUE(navigator.set_paused(*run_, false)) << run_->err();
  }

  std::size_t read_ = 0;  // bytes of its stderr that were there at the last kill
};

TEST_F(GotoLives, TheRobotIsFoundWhereItIsAndDrivesOn) {
  use_udp_only();
  ASSERT_NO_FATAL_FAILURE(map_world(scratch_, "floor"));
  std::deque<Services> groups = {
      {"sensor_gateway"},
      {"navigator"},
      {"planner"},
      {"map_store"},
      {"local_mapper"},
      {"localizer"},
      {"local_mapper", "localizer"},
  };
  // On a busy machine the robot may arrive before all of them were killed; then it drives once
  // more.
  ASSERT_TRUE(wait_for("drives in which services are killed and come back", [&] {
    drive_and_kill(groups);
    return HasFailure() || groups.empty();
  }));
  EXPECT_THAT(run_->out(), HasSubstr("arrived at 8,0"));
  EXPECT_THAT(run_->out(), HasSubstr(" 0 collisions"));
}

TEST(Goto, AlongBranchesWhereTheConfigurationSaysSo) {
  use_udp_only();
  const Scratch scratch;
  ASSERT_NO_FATAL_FAILURE(map_world(scratch, "floor"));
  std::ofstream(scratch / "graph.yaml") << "planner:\n  on: graph\n";
  Program run(scratch, "topogeo",
              {"run", "--sim", std::string(TOPOGEO_SHARE) + "/worlds/floor.world.yaml", "--map",
               scratch / "map/map.pb", "--goto", "2.5,0", "--patience", "600", "--config",
               scratch / "graph.yaml", "--out", scratch / "out", "--workers", "0", "--domain",
               own_domain()});
  ASSERT_EQ(run.wait(), 0) << run.err();
  EXPECT_THAT(run.err(), HasSubstr("m of it along branches"));
  EXPECT_THAT(run.out(), HasSubstr(" 0 collisions"));
}

TEST(Explore, ASimulatedRobotMapsARoomByItself) {
  use_udp_only();
  const Scratch scratch;
  const std::string out = scratch / "out";
  Program run(scratch, "topogeo",
              {"run", "--sim", std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml", "--explore",
               "--out", out, "--workers", "0", "--domain", own_domain()});
  ASSERT_EQ(run.wait(), 0) << run.err();
  EXPECT_THAT(run.err(), HasSubstr("no reachable target is left"));
  EXPECT_THAT(run.out(), Not(HasSubstr("collisions")));
  EXPECT_TRUE(std::filesystem::exists(out + "/map.pb"));
}

TEST(Explore, SaysWhoIsMissing) {
  use_udp_only();
  const Scratch scratch;
  Program command(scratch, "topogeo",
                  {"explore", "--domain", own_domain(), "--wait-seconds", "0.5"});
  EXPECT_EQ(command.wait(), 1);
  EXPECT_THAT(command.err(), HasSubstr("no planner and no navigator"));
}

// The floor is drawn, and the robot starts on its base station; there is no laser, so neither local
// mapper nor localizer.
TEST(Goto, ARobotWithSonarsAloneIsSentFromItsBaseStationToARoom) {
  use_udp_only();
  const Scratch scratch;
  const std::string world = scratch / "rooms.world.yaml";
  // The last list of the file is that of the places.
  std::ofstream(world) << read_file(std::string(TOPOGEO_SHARE) + "/worlds/rooms.world.yaml")
                       << "  - {name: base station, at: [2.0, 1.6], heading: 1.5707963}\n";
  Program import(scratch, "topogeo",
                 {"store", "import", world, "--format", "drawing", "--out", scratch / "map.pb"});
  ASSERT_EQ(import.wait(), 0) << import.err();
  Program run(scratch, "topogeo",
              {"run", "--sim", world, "--no-laser", "--map", scratch / "map.pb", "--goto",
               "workroom", "--patience", "600", "--config",
               std::string(TOPOGEO_SOURCE_DIR) + "/deploy/sonar_robot.example.yaml", "--out",
               scratch / "out", "--workers", "0", "--domain", own_domain()});
  ASSERT_EQ(run.wait(), 0) << run.err();
  EXPECT_THAT(run.out(), HasSubstr("arrived at workroom"));
  EXPECT_THAT(run.out(), HasSubstr(" 0 collisions"));
  const auto truth = storage::read_trajectory_tum(scratch / "out/truth.tum");
  ASSERT_FALSE(truth.empty());
  EXPECT_LT((truth.back().pose.position_m() - Eigen::Vector2d(2.6, 6.4)).norm(), 0.2);
}

TEST(Goto, WithoutALaserItHasToBeFoundByMarkovLocalization) {
  const Scratch scratch;
  Program run(scratch, "topogeo",
              {"run", "--sim", std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml", "--no-laser",
               "--map", scratch / "map.pb", "--goto", "3,0", "--out", scratch / "out"});
  EXPECT_EQ(run.wait(), 2);
  EXPECT_THAT(run.err(), HasSubstr("pose_source: markov"));
}

TEST(Goto, WithoutAMapNothingStarts) {
  const Scratch scratch;
  Program run(scratch, "topogeo",
              {"run", "--sim", std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml", "--goto",
               "3,0", "--out", scratch / "out"});
  EXPECT_EQ(run.wait(), 2);
  EXPECT_THAT(run.err(), HasSubstr("--map"));
}

}  // namespace
}  // namespace topogeo::test
