// Two robots map one floor at the same time into one map store, with one localizer for both. Their
// maps become one after they saw the same place or the operator agreed, whatever is killed.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/archive.h"
#include "topogeo/msg/local_map.h"
#include "topogeo/msg/status.h"
#include "topogeo/msg/store.h"
#include "topogeo/msg/stream.h"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/read_map.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/world/world.hpp"

#include "map_error.hpp"
#include "program.hpp"

namespace topogeo::test {
namespace {

using geometry::Pose2;
using testing::HasSubstr;

/// The stops of a robot's drive through the floor, and its true poses.
struct FloorDrive {
  FloorDrive(const std::string& robot, const std::vector<Eigen::Vector2d>& tour_m) {
    world::World world = world::load_world(std::string(TOPOGEO_SHARE) + "/worlds/floor.world.yaml");
    world.tour_m = tour_m;
    const simulation::SimulatedLog log = simulation::simulate_log(world, {});
    pipeline::LocalMapper mapper({}, robot, robot == "a" ? 1 : 2);
    const auto keep = [&](const std::optional<topomap::LocalMap>& map) {
      if (!map) return;
      stops.push_back(*map);
      T_world_robot.push_back(log.T_world_robot[map->sequence]);
    };
    for (const scan::Scan& scan : log.scans) keep(mapper.add(scan));
    keep(mapper.finish());
  }
  std::vector<topomap::LocalMap> stops;
  std::vector<Pose2> T_world_robot;
};

class SharedMapServices : public testing::Test {
 protected:
  SharedMapServices() {
    loop_.add<msg::ArchiveReply>(
        replies_, [this](const msg::ArchiveReply& reply, const auto&) { reply_ = reply; });
    loop_.add<msg::StoredMap>(
        stored_,
        [this](const msg::StoredMap& stored, const auto&) {
          newest_[stored.robot_id().to_string()] = stored;
        },
        [this](const messaging::SampleInfo& info) {
          if (info.state == messaging::InstanceState::kDisposed) ++withdrawn_;
        });
    loop_.add<msg::WorkerStatus>(
        messaging::Reader<msg::WorkerStatus>(participant_),
        [this](const msg::WorkerStatus& worker, const messaging::SampleInfo& info) {
          if (info.valid) tasks_done_ = std::max(tasks_done_, worker.tasks_done());
        });
  }

  [[nodiscard]] std::vector<std::string> domain() const {
    return {"--domain", own_domain(), "--partition", partition_};
  }
  [[nodiscard]] std::unique_ptr<Program> start(const std::string& name,
                                               std::vector<std::string> words) const {
    words.insert(words.end(), {"--robot-id", "a", "--with-robots", "b"});
    for (const std::string& word : domain()) words.push_back(word);
    return std::make_unique<Program>(scratch_, name, words);
  }
  [[nodiscard]] std::unique_ptr<Program> start_store() const {
    return start("map_store", {"--out", (scratch_ / "out").string()});
  }
  [[nodiscard]] std::unique_ptr<Program> start_localizer(const std::string& merge = "auto") const {
    const std::filesystem::path config = scratch_ / "config.yaml";
    std::ofstream(config) << "localizer:\n  merge: " << merge << '\n';
    return start("localizer", {"--config", config.string()});
  }
  /// Output of `topogeo store ...`, which must exit with `code`.
  std::string store_command(std::vector<std::string> words, int code = 0) const {
    words.insert(words.begin(), "store");
    Program program(scratch_, "topogeo", words);
    EXPECT_EQ(program.wait(), code) << program.err();
    return program.out() + program.err();
  }
  std::string merge_command(std::vector<std::string> words, int code = 0) const {
    words.insert(words.end(), {"--robot-id", "a", "--wait-seconds", "600"});
    for (const std::string& word : domain()) words.push_back(word);
    return store_command(std::move(words), code);
  }

  template <class Condition>
  bool eventually(const std::string& what, const Condition& condition) {
    return wait_in_loop(loop_, what, condition);
  }
  [[nodiscard]] std::uint32_t stops_in_map() { return newest_["a"].stops(); }
  [[nodiscard]] bool stored(const std::string& robot, std::size_t stops) {
    return newest_[robot].session_stops() >= stops;
  }

  /// Sends the stops of both in turn, up to so many of each.
  void send(std::size_t stops) {
    for (; sent_ < stops; ++sent_) {
      for (const FloorDrive* drive : {&a_, &b_}) {
        if (sent_ >= drive->stops.size()) continue;
        EXPECT_TRUE(maps_.write(service::to_msg(drive->stops[sent_])));
      }
    }
  }
  void send_all() {
    send(std::max(a_.stops.size(), b_.stops.size()));
    for (const FloorDrive* drive : {&a_, &b_}) {
      msg::StreamEnd end;
      messaging::set_header(end, drive->stops.front().robot_id, 0, 0);
      end.stage(msg::kStageLocalMapper);
      end.count(drive->stops.size());
      end.last_id(drive->stops.size() - 1);
      EXPECT_TRUE(ends_.write(end));
    }
  }
  /// The map store's answer to a request that is sent once.
  msg::ArchiveReply ask(msg::ArchiveAction action, const std::string& name) {
    msg::ArchiveRequest request;
    messaging::set_header(request, "a", 0, requests_sent_);
    messaging::set_client_id(request, "operator");
    request.request_id(++requests_sent_);
    request.action(action);
    messaging::set_text(request.name(), name, "name");
    EXPECT_TRUE(requests_.write(request));
    EXPECT_TRUE(eventually("the answer to a request", [&] {
      return reply_.request_id() == requests_sent_;
    })) << name;
    return reply_;
  }
  [[nodiscard]] double error_m(const storage::MapDocument& map) const {
    return largest_error_m(map, [&](const topomap::LocalMap& stop) {
      const FloorDrive& drive = stop.robot_id == "a" ? a_ : b_;
      return drive.T_world_robot[stop.stop.number];
    });
  }

  const bool udp_only_ = (use_udp_only(), true);
  std::string partition_ = "shared" + std::to_string(std::random_device{}());
  Scratch scratch_;
  FloorDrive a_{"a", {{1.3, 1.2}, {15.0, 1.15}, {28.9, 1.2}, {28.9, 12.0}}};
  FloorDrive b_{"b", {{1.3, 9.6}, {1.3, 1.2}, {15.0, 1.15}, {24.0, 1.2}}};
  messaging::Participant participant_{[this] {
    messaging::ParticipantOptions options;
    options.domain = static_cast<std::uint32_t>(std::stoul(own_domain()));
    options.partition = partition_;
    options.name = "robots";
    return options;
  }()};
  messaging::Writer<msg::LocalMap> maps_{participant_};
  messaging::Writer<msg::StreamEnd> ends_{participant_};
  messaging::Writer<msg::ArchiveRequest> requests_{participant_};
  messaging::Reader<msg::ArchiveReply> replies_{participant_};
  messaging::Reader<msg::StoredMap> stored_{participant_};
  messaging::EventLoop loop_;
  std::map<std::string, msg::StoredMap> newest_;  // by robot
  std::uint64_t tasks_done_ = 0;                  // of the busiest worker
  std::size_t withdrawn_ = 0;                     // maps of robots
  std::uint64_t requests_sent_ = 0;
  msg::ArchiveReply reply_;  // the newest
  std::size_t sent_ = 0;
};

TEST_F(SharedMapServices, MakeOneMapWhateverIsKilledAndItIsSplitAgain) {
  auto store = start_store();
  auto localizer = start_localizer();
  const std::size_t part = 2 * b_.stops.size() / 3;
  send(part);
  ASSERT_TRUE(eventually("stops of both robots in the map",
                         [&] { return stops_in_map() >= part + part / 2; }))
      << stops_in_map() << " of " << 2 * part << "; " << localizer->err();
  localizer->send_signal(SIGKILL);
  EXPECT_EQ(localizer->wait(), 128 + SIGKILL);
  send(part + 3);
  ASSERT_TRUE(eventually("the stops of both robots to be stored",
                         [&] { return stored("a", part + 3) && stored("b", part + 3); }));
  store->send_signal(SIGKILL);
  EXPECT_EQ(store->wait(), 128 + SIGKILL);
  localizer = start_localizer();  // waits for the store
  store = start_store();
  localizer->wait_for_error_text("resuming with a map of ");
  send_all();
  store->wait_for_error_text("local maps, ");  // the final line
  const storage::MapDocument map = storage::read_map_file(scratch_ / "out" / "map.pb");
  EXPECT_EQ(map.robot_id, "a");
  ASSERT_EQ(map.trajectory.stops.size(), a_.stops.size() + b_.stops.size()) << localizer->err();
  EXPECT_LT(error_m(map), 0.3);
  for (const std::string robot : {"a", "b"}) {
    EXPECT_EQ(std::ranges::count(map.local_maps, robot, &topomap::LocalMap::robot_id),
              static_cast<std::ptrdiff_t>((robot == "a" ? a_ : b_).stops.size()));
  }
  for (auto* program : {localizer.get(), store.get()}) {
    program->send_signal(SIGTERM);
    EXPECT_EQ(program->wait(), 0) << program->err();
  }
  const std::string database = (scratch_ / "out" / "map.sqlite").string();
  EXPECT_THAT(store_command({"check", database}), HasSubstr("no fault found"));
  // The merge can be undone.
  const std::string split = (scratch_ / "split.pb").string();
  store_command({"remove-session", database, fmt::format("{:016x}", b_.stops.front().stop.session),
                 "--out", split});
  const storage::MapDocument alone = storage::read_map_file(split);
  EXPECT_EQ(alone.trajectory.stops.size(), a_.stops.size());
  EXPECT_LT(error_m(alone), 0.3);
}

TEST_F(SharedMapServices, MakeTheSameBytesWithAnyNumberOfWorkers) {
  auto store = start_store();
  send_all();
  ASSERT_TRUE(eventually("all stops to be stored", [&] {
    return stored("a", a_.stops.size()) && stored("b", b_.stops.size());
  }));
  store->send_signal(SIGTERM);
  EXPECT_EQ(store->wait(), 0) << store->err();
  // All data is stored before the localizer starts, so that the order of arrival has no effect.
  const std::filesystem::path out = scratch_ / "out";
  std::filesystem::copy(out, scratch_ / "kept");
  std::vector<std::string> maps;
  for (const std::size_t workers : {0U, 2U}) {
    std::filesystem::remove_all(out);
    std::filesystem::copy(scratch_ / "kept", out);
    std::vector<std::unique_ptr<Program>> pool;
    for (std::size_t i = 0; i < workers; ++i) {
      pool.push_back(std::make_unique<Program>(scratch_, "ga_worker", domain()));
    }
    store = start_store();
    const auto localizer = start_localizer();
    localizer->wait_for_error_text("adding ");
    send_all();
    store->wait_for_error_text("local maps, ");  // the final line
    maps.push_back(read_file(out / "map.pb"));
    if (workers > 0) {
      EXPECT_TRUE(eventually("tasks of the workers", [&] { return tasks_done_ > 0; }));
    }
    store->send_signal(SIGTERM);
    EXPECT_EQ(store->wait(), 0) << store->err();
  }
  EXPECT_FALSE(maps[0].empty());
  EXPECT_TRUE(maps[0] == maps[1]);
}

TEST_F(SharedMapServices, AskBeforeTheyMakeOneMap) {
  const auto store = start_store();
  auto localizer = start_localizer("ask");
  send(b_.stops.size());
  const auto shows = [&](const std::string& text) {
    return eventually("a merge in that state", [&] {
      return merge_command({"merges", "--json"}).find(text) != std::string::npos;
    });
  };
  ASSERT_TRUE(shows("\"state\": \"open\""));
  ASSERT_TRUE(eventually("the stops of robot b to be stored",
                         [&] { return stored("b", b_.stops.size()); }));
  EXPECT_LE(stops_in_map(), a_.stops.size());
  EXPECT_THAT(merge_command({"accept", "7"}, 1), HasSubstr("merge 7 does not exist"));
  EXPECT_THAT(merge_command({"merges"}), HasSubstr("1  open: stop "));
  EXPECT_TRUE(eventually("the status to name the command that accepts the merge", [&] {
    Program status(scratch_, "topogeo", {"status", "--domain", own_domain(), "--json"});
    return status.wait() == 0 && status.out().find("topogeo store accept 1") != std::string::npos;
  }));
  // A restarted localizer proposes an open merge again.
  localizer->send_signal(SIGKILL);
  EXPECT_EQ(localizer->wait(), 128 + SIGKILL);
  localizer = start_localizer("ask");
  ASSERT_TRUE(shows("\"state\": \"open\""));
  EXPECT_THAT(merge_command({"accept", "1"}), HasSubstr("the maps are merged"));
  EXPECT_TRUE(eventually("the maps to be one", [&] { return stops_in_map() > a_.stops.size(); }));
  EXPECT_TRUE(shows("\"state\": \"accepted\""));
  EXPECT_THAT(merge_command({"refuse", "1"}, 1), HasSubstr("no longer open"));
}

// Refused 5 m after `b` reached the start of `a`, and restarted less than 10 m further on.
TEST_F(SharedMapServices, ARefusalIsHeededByALocalizerThatStartsAgain) {
  const auto store = start_store();
  auto localizer = start_localizer("ask");
  const auto proposals = [&] { return merge_command({"merges", "--json"}); };
  std::size_t stops = 0;
  while (stops < b_.stops.size() && proposals().find("\"state\": \"open\"") == std::string::npos) {
    send(stops += 2);
    // Waits for the localizer, too, because stored stops may still be pending there.
    ASSERT_TRUE(eventually("the stops to be stored", [&] {
      return stored("b", std::min(stops, b_.stops.size())) &&
             stops_in_map() >= std::min(stops, a_.stops.size());
    }));
  }
  ASSERT_LT(stops + 4, b_.stops.size());
  EXPECT_THAT(merge_command({"refuse", "1"}), HasSubstr("the maps stay separate"));
  const std::string refused = proposals();
  const std::string database = (scratch_ / "out" / "map.sqlite").string();
  ASSERT_TRUE(eventually("the refusal to be stored",
                         [&] { return storage::read_map(database).refused_merges.size() == 1; }));
  localizer->send_signal(SIGKILL);
  EXPECT_EQ(localizer->wait(), 128 + SIGKILL);
  localizer = start_localizer("ask");
  localizer->wait_for_error_text("adding ");
  send(stops + 2);
  ASSERT_TRUE(eventually("the stops to be stored",
                         [&] { return stored("b", stops + 2) && stops_in_map() >= stops + 2; }));
  EXPECT_EQ(proposals(), "[]\n") << refused;
  send_all();  // b reaches places further away
  EXPECT_TRUE(eventually("the merge to be proposed again", [&] {
    return proposals().find("\"state\": \"open\"") != std::string::npos;
  }));
}

TEST_F(SharedMapServices, BeginAnewWithASnapshotThatIsRestored) {
  const auto store = start_store();
  const auto localizer = start_localizer();
  const std::size_t part = 2 * b_.stops.size() / 3;
  send(part);
  ASSERT_TRUE(eventually("stops of both robots in the map",
                         [&] { return stops_in_map() >= part + part / 2; }))
      << stops_in_map() << " of " << 2 * part << "; " << localizer->err();
  ASSERT_TRUE(eventually("the map store",
                         [&] { return requests_.matched() > 0 && replies_.matched() > 0; }));
  const msg::ArchiveReply taken = ask(msg::kArchiveTake, "one");
  ASSERT_TRUE(taken.accepted()) << taken.message().c_str();
  const std::uint32_t stops = taken.snapshots().front().stops();
  ASSERT_GE(stops, part + part / 2) << "of both robots";
  send(part + 6);
  ASSERT_TRUE(eventually("stops after the snapshot", [&] { return stops_in_map() > stops; }));

  ASSERT_TRUE(ask(msg::kArchiveRestore, "one").accepted());
  ASSERT_TRUE(
      eventually("the maps of both robots to be withdrawn", [&] { return withdrawn_ == 2; }))
      << withdrawn_ << ": what makes the mappers of both robots begin anew";
  store->wait_for_error_text("restored snapshot one");
  localizer->wait_for_error_text("restarting with the new map");
  localizer->wait_for_error_text(fmt::format("resuming with a map of {} stops", stops));
  const std::string database = (scratch_ / "out" / "map.sqlite").string();
  EXPECT_THAT(store_command({"snapshots", database}), HasSubstr("before-one"));

  // Both robots continue in it.
  send_all();
  store->wait_for_error_text("local maps, ");  // the final line
  const storage::MapDocument map = storage::read_map_file(scratch_ / "out" / "map.pb");
  EXPECT_EQ(map.trajectory.stops.size(), a_.stops.size() + b_.stops.size()) << localizer->err();
  EXPECT_LT(error_m(map), 0.3);
}

TEST_F(SharedMapServices, ASecondLocalizerOfOneOfTheRobotsIsReported) {
  const auto store = start_store();
  const auto localizer = start_localizer();
  localizer->wait_for_error_text("");
  Program usage(scratch_, "localizer", {"--with-robots", "b,b"});
  EXPECT_EQ(usage.wait(), 2);
  EXPECT_THAT(usage.err(), HasSubstr("expected each robot once, got 'b' again"));
  std::vector<std::string> words{"--robot-id", "b", "--with-robots", "a", "--standalone"};
  for (const std::string& word : domain()) words.push_back(word);
  ASSERT_TRUE(eventually("a stored map", [&] { return !newest_.empty(); }));
  Program second(scratch_, "localizer", words);
  EXPECT_EQ(second.wait(), 1) << second.err();
  EXPECT_THAT(second.err(), HasSubstr("another localizer already runs for robot"));
}

}  // namespace
}  // namespace topogeo::test
