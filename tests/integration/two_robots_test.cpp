// Two robots with gateways and local mappers of their own fill one map store.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/store.h"
#include "topogeo/scan/carmen_log_writer.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/world/world.hpp"

#include "map_error.hpp"
#include "program.hpp"

namespace topogeo::test {
namespace {

using geometry::Pose2;

class TwoRobotsTest : public testing::Test {
 protected:
  TwoRobotsTest() {
    write_drive("a", {{1.3, 1.2}, {15.0, 1.15}, {28.9, 1.2}, {28.9, 12.0}});
    write_drive("b", {{1.3, 9.6}, {1.3, 1.2}, {15.0, 1.15}, {24.0, 1.2}});
    messaging::ParticipantOptions options;
    options.domain = static_cast<std::uint32_t>(std::stoul(own_domain()));
    options.partition = partition_;
    options.name = "observer";
    participant_.emplace(options);
    loop_.add<msg::StoredMap>(messaging::Reader<msg::StoredMap>(*participant_),
                              [this](const msg::StoredMap& stored, const auto&) {
                                newest_[stored.robot_id().to_string()] = stored;
                              });
  }

  [[nodiscard]] std::unique_ptr<Program> start(const std::string& service, const std::string& robot,
                                               std::vector<std::string> words = {}) const {
    words.insert(words.end(),
                 {"--domain", own_domain(), "--partition", partition_, "--robot-id", robot});
    return std::make_unique<Program>(scratch_, service, words);
  }
  [[nodiscard]] std::unique_ptr<Program> start_mapper(const std::string& robot) const {
    return start("local_mapper", robot);
  }
  [[nodiscard]] std::unique_ptr<Program> start_gateway(const std::string& robot) const {
    return start("sensor_gateway", robot,
                 {"--log", scratch_ / (robot + ".clf"), "--rate", std::to_string(kRate)});
  }

  [[nodiscard]] std::uint32_t wait_for_stops(const std::string& robot, std::uint32_t stops) {
    EXPECT_TRUE(wait_in_loop(loop_, "stored stops of robot " + robot,
                             [&] { return newest_[robot].session_stops() >= stops; }));
    return newest_[robot].session_stops();
  }
  [[nodiscard]] storage::MapDocument stored_map() const {
    return storage::read_map_file(scratch_ / "out" / "map.pb");
  }
  [[nodiscard]] double error_m(const storage::MapDocument& map) const {
    return largest_error_m(map, [&](const topomap::LocalMap& stop) {
      return T_world_robot_.at(stop.robot_id).at(stop.stamp_ns);
    });
  }

  static constexpr int kRate = 4;  // times real time
  const bool udp_only_ = (use_udp_only(), true);
  std::string partition_ = "two" + std::to_string(std::random_device{}());
  Scratch scratch_;
  std::optional<messaging::Participant> participant_;
  messaging::EventLoop loop_;
  std::map<std::string, msg::StoredMap> newest_;  // by robot

 private:
  void write_drive(const std::string& robot, const std::vector<Eigen::Vector2d>& tour_m) {
    world::World floor = world::load_world(std::string(TOPOGEO_SHARE) + "/worlds/floor.world.yaml");
    floor.tour_m = tour_m;
    const simulation::SimulatedLog log = simulation::simulate_log(floor, {});
    scan::CarmenLogWriter writer(scratch_ / (robot + ".clf"), {});
    for (std::size_t i = 0; i < log.scans.size(); ++i) {
      writer.write(log.scans[i]);
      T_world_robot_[robot][log.scans[i].stamp_ns] = log.T_world_robot[i];
    }
    writer.close();
  }

  std::map<std::string, std::map<std::int64_t, Pose2>> T_world_robot_;  // by robot and stamp_ns
};

TEST_F(TwoRobotsTest, GoOnInOneMapWhenALocalMapperIsKilled) {
  set_longest_freeze(0);
  const auto store =
      start("map_store", "a", {"--with-robots", "b", "--out", (scratch_ / "out").string()});
  const auto localizer = start("localizer", "a", {"--with-robots", "b"});
  const auto mapper_a = start_mapper("a");
  auto mapper_b = start_mapper("b");
  const auto gateway_a = start_gateway("a");
  // The error grows with the distance from the first stop, which must not depend on the machine.
  ASSERT_GE(wait_for_stops("a", 1), 1U) << mapper_a->err();
  const auto gateway_b = start_gateway("b");
  const std::uint32_t before = wait_for_stops("b", 6);
  ASSERT_GE(before, 6U) << mapper_b->err();
  const std::uint64_t session = newest_["b"].session();
  // The robot waits, because its unseen path would depend on the machine's load.
  gateway_b->send_signal(SIGSTOP);
  mapper_b->send_signal(SIGKILL);
  EXPECT_EQ(mapper_b->wait(), 128 + SIGKILL);
  mapper_b = start_mapper("b");
  mapper_b->wait_for_error_text("resuming after stop ");
  gateway_b->send_signal(SIGCONT);
  EXPECT_GT(wait_for_stops("b", newest_["b"].session_stops() + 3), before);
  EXPECT_EQ(newest_["b"].session(), session);
  store->wait_for_error_text("local maps, ");  // the final line
  const storage::MapDocument map = stored_map();
  EXPECT_EQ(map.trajectory.stops.size(), map.local_maps.size());
  for (const std::string robot : {"a", "b"}) {
    const auto stops = std::ranges::count(map.local_maps, robot, &topomap::LocalMap::robot_id);
    // The other robot may have come to its end before.
    EXPECT_GE(stops, newest_[robot].session_stops() + (robot == "b" ? 1 : 0));
  }
  EXPECT_LT(error_m(map), 0.3);
}

}  // namespace
}  // namespace topogeo::test
