// Strangers on the network of a run: participants that come and go, samples of absurd content,
// unknown topics, garbage packets at the ports. The map must equal that of one process, the memory
// of all services stays small, and their statuses count what was refused.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/types.h"

#include "garbage.hpp"
#include "program.hpp"
#include "stranger.hpp"
#include "waiting.hpp"

namespace topogeo::test {
namespace {

using std::chrono::milliseconds;

/// Memory limit of any service after a long log.
constexpr std::size_t kMostMemoryMb = kTimeFactor == 1 ? 150 : 600;  // a sanitizer takes its own

std::size_t memory_mb(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
  std::size_t all_pages = 0;
  std::size_t resident_pages = 0;
  file >> all_pages >> resident_pages;
  return resident_pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) >> 20U;
}

class StrangersTest : public testing::Test {
 protected:
  StrangersTest() {
    use_udp_only();
    write_log("room", scratch_ / "log.clf");
    Program map(scratch_, "topogeo",
                {"map", "--log", scratch_ / "log.clf", "--out", scratch_ / "alone"});
    EXPECT_EQ(map.wait(), 0) << map.err();
  }

  /// Starts a run of the log that lasts some ten seconds, or longer at a lower rate.
  void start(const std::string& rate = "3") {
    rate_ = rate;
    run_ = std::make_unique<Program>(
        scratch_, "topogeo",
        std::vector<std::string>{"run", "--log", scratch_ / "log.clf", "--out", scratch_ / "out",
                                 "--rate", rate, "--workers", "1", "--domain", domain_});
    run_->wait_for_progress(5);
  }

  /// Tracks the highest memory of each service and all reported faults until the run ends.
  void finish() {
    EXPECT_EQ(run_->wait(), 0) << run_->err();
    EXPECT_TRUE(read_file(scratch_ / "out/map.pb") == read_file(scratch_ / "alone/map.pb"));
    EXPECT_LE(most_memory_mb_, kMostMemoryMb);
    RecordProperty("most_memory_mb", static_cast<int>(most_memory_mb_));
  }

  void look() {
    for (const pid_t pid : run_->services()) {
      most_memory_mb_ = std::max(most_memory_mb_, memory_mb(pid));
    }
    statuses_.take([this](const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
      if (!info.valid || status.robot_id() == "stranger") return;  // of AbsurdSamples
      const std::string service = status.service().to_string() + ": ";
      for (const msg::FaultCount& fault : status.faults()) {
        note(faults_[service + fault.reason().to_string()], fault.count());
      }
      for (const msg::FaultCount& drop : status.drops()) {
        note(drops_[service + drop.reason().to_string()], drop.count());
      }
    });
  }

  /// Starts another run of the same log when one is over, which depends on the machine.
  void keep_running() {
    if (!run_->ended()) return;
    finish();
    start(rate_);
  }

  /// Writes at least `least` times, until services have reported all of these reasons.
  template <class Samples>
  void write_until_counted(Samples& samples, const std::vector<std::string>& reasons,
                           std::uint64_t least) {
    const auto counted = [this](const std::string& reason) { return faults_[reason] > 0; };
    std::uint64_t written = 0;
    EXPECT_TRUE(wait_for(
        "services to count what is absurd",
        [&] { return written >= least && std::ranges::all_of(reasons, counted); },
        [&] {
          keep_running();
          samples.write(written++);
          pace();
        }));
  }

  /// Pause between two turns of a stranger, because services need time for their own work.
  void pace() {
    std::this_thread::sleep_for(milliseconds(20));  // pacing
    look();
  }

  std::uint32_t domain() const { return static_cast<std::uint32_t>(std::stoul(domain_)); }

  messaging::ParticipantOptions anywhere(const std::string& name) const {
    messaging::ParticipantOptions options;
    options.domain = domain();
    options.partition = "*";
    options.name = name;
    return options;
  }

  static void note(std::uint64_t& most, std::uint64_t count) { most = std::max(most, count); }

  Scratch scratch_;
  std::string domain_ = own_domain();
  messaging::Participant participant_{anywhere("test")};
  messaging::Reader<msg::ServiceStatus> statuses_{participant_};
  std::unique_ptr<Program> run_;
  std::string rate_;
  std::size_t most_memory_mb_ = 0;
  std::map<std::string, std::uint64_t> faults_;
  std::map<std::string, std::uint64_t> drops_;
};

TEST_F(StrangersTest, AHundredParticipantsComeAndGo) {
  start();
  for (int i = 0; i < 100; ++i) {
    const messaging::Participant stranger(anywhere("stranger"));
    messaging::Writer<msg::BaseCommand> writer(stranger);
    const messaging::Reader<msg::LocalMap> reader(stranger);
    keep_running();
    look();
  }
  finish();
}

TEST_F(StrangersTest, SamplesOfAbsurdContentAreRefusedAndCounted) {
  start("1");
  AbsurdSamples samples(participant_, domain());
  write_until_counted(
      samples,
      {"local_mapper: invalid scan", "localizer: invalid local map", "localizer: invalid odometry",
       "localizer: invalid tracked pose", "localizer: invalid localization command",
       "ga_worker: invalid local map", "ga_worker: task refused", "map_store: invalid local map",
       "map_store: invalid trajectory", "map_store: invalid loop closures",
       "map_store: invalid map edges", "map_store: invalid merge proposal", "planner: invalid pose",
       "planner: invalid goal", "planner: invalid blockages", "planner: invalid grid tile",
       "planner: invalid hybrid map"},
      50);
  NoMessages no_messages(domain());
  write_until_counted(no_messages,
                      {"map_store: invalid_sample", "planner: invalid_sample",
                       "localizer: invalid_sample", "ga_worker: invalid_sample"},
                      40);
  finish();
}

// The same for drives with devices and navigator in a finished map, until services have reported
// everything: how much reaches them in one drive depends on the machine.
TEST_F(StrangersTest, ADriveGoesOnAmongSamplesOfAbsurdContent) {
  const std::vector<const char*> reasons = {"sensor_gateway: invalid motion command",
                                            "sensor_gateway: invalid limits",
                                            "simulator: invalid simulator command",
                                            "navigator: invalid goal",
                                            "navigator: invalid route",
                                            "navigator: invalid pose",
                                            "navigator: invalid odometry",
                                            "navigator: invalid scan",
                                            "navigator: invalid sonar",
                                            "navigator: invalid grid tile",
                                            "navigator: invalid hybrid map"};
  AbsurdSamples samples(participant_, domain());
  std::uint64_t written = 0;
  const auto drive = [&] {
    run_ = std::make_unique<Program>(
        scratch_, "topogeo",
        std::vector<std::string>{"run", "--sim",
                                 std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml", "--map",
                                 scratch_ / "alone/map.pb", "--goto", "3,0", "--patience", "600",
                                 "--out", scratch_ / "out", "--workers", "1", "--domain", domain_});
    while (!run_->ended()) {
      samples.write(written++);
      pace();
    }
    EXPECT_EQ(run_->wait(), 0) << run_->err();
    EXPECT_THAT(run_->out(), testing::HasSubstr("arrived at 3,0"));
    EXPECT_THAT(run_->out(), testing::HasSubstr(" 0 collisions"));
  };
  drive();
  EXPECT_TRUE(wait_for(
      "services to count what is absurd",
      [&] {
        return HasFailure() || std::ranges::all_of(reasons, [&](const char* reason) {
                 return faults_[reason] > 0;
               });
      },
      drive))
      << testing::PrintToString(faults_);
  EXPECT_LE(most_memory_mb_, kMostMemoryMb);
  RecordProperty("most_memory_mb", static_cast<int>(most_memory_mb_));
}

TEST_F(StrangersTest, TopicsThatDoNotExistAreCounted) {
  start("1");
  UnknownTopics topics(domain());
  EXPECT_TRUE(wait_for(
      "the planner to count unknown topics",
      [&] { return topics.size() >= 300 && drops_["planner: unknown_topic"] > 0; },
      [&] {
        keep_running();
        topics.add();
        look();
      }));
  finish();
}

// ---- packets

class GarbageTest : public StrangersTest {
 protected:
  GarbageTest() {
    to_.sin_family = AF_INET;
    ::inet_pton(AF_INET, "127.0.0.1", &to_.sin_addr);
  }
  GarbageTest(const GarbageTest&) = delete;
  GarbageTest& operator=(const GarbageTest&) = delete;
  ~GarbageTest() override { ::close(socket_); }

  /// Starts the run and returns the announcements of its participants.
  std::vector<Packet> start_and_listen(const std::string& rate = "3") {
    Announcements announcements(first_port_);
    start(rate);
    std::vector<Packet> real;
    Wait wait("announcements of participants");
    while (real.size() < 10) {
      if (!wait.goes_on()) throw std::runtime_error("nobody announces itself");
      Packet packet = announcements.next();
      if (packet.size() > 60) real.push_back(std::move(packet));
    }
    return real;
  }

  /// Sends to one of the ports that participants of a host may have.
  void send(const Packet& packet, std::size_t number) {
    to_.sin_port = htons(static_cast<std::uint16_t>(first_port_ + 10 + number % 16));
    ::sendto(socket_, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to_),
             sizeof to_);  // NOLINT: their interface
  }

  void send_some(Garbage& garbage) {
    for (std::size_t i = 0; i < kSome; ++i) {
      send(garbage.next(), i);
      if (i % 20 == 0) std::this_thread::sleep_for(milliseconds(2));  // pacing: sockets overflow
    }
    look();
  }

  static constexpr std::size_t kSome = 500;
  static constexpr std::size_t kMuch = 20'000;
  const std::uint16_t first_port_ = static_cast<std::uint16_t>(7400 + 250 * std::stoul(domain_));

 private:
  int socket_ = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to_{};
};

TEST_F(GarbageTest, OfUnknownPeersIsDropped) {
  Garbage garbage(start_and_listen(), true);
  std::size_t sent = 0;
  Wait wait("the localizer to count what is dropped");
  EXPECT_TRUE(wait_for(
      wait, [&] { return sent >= kMuch && drops_["localizer: invalid_packet"] > 0; },
      [&] {
        keep_running();
        send_some(garbage);
        sent += kSome;
        if (sent < kMuch) wait.renew();
      }));
  finish();
}

// Without security a stranger can act in a peer's name, so the run may end differently. But no
// service may die, hang or grow.
TEST_F(GarbageTest, InTheNameOfPeersKillsNoService) {
  // A slow machine sends for longer than a run lasts; then the peers of another run get the rest.
  for (std::size_t sent = 0; sent < kMuch;) {
    Garbage garbage(start_and_listen("0.3"), false);
    const std::vector<pid_t> services = run_->services();
    for (; sent < kMuch && run_->services() == services; sent += kSome) send_some(garbage);
    // Either the run is over, or a service has died, which the run reports.
    if (run_->services() != services) static_cast<void>(run_->wait());
    for (const char* death : {"was killed by signal", "ended with exit code"}) {
      ASSERT_THAT(run_->err(), testing::Not(testing::HasSubstr(death)));
    }
    run_->send_signal(SIGINT);
    static_cast<void>(run_->wait());
  }
  EXPECT_LE(most_memory_mb_, kMostMemoryMb);
}

/// A writer's list of parameters with an additional one.
Packet announced_writer(const Packet& guid_prefix, std::uint8_t number, const Packet& parameter) {
  Packet list = {0, 3, 0, 0, 0x5a, 0, 16, 0};
  list.insert(list.end(), guid_prefix.begin(), guid_prefix.end());
  list.insert(list.end(), {0, 0, number, 2, 0x05, 0, 8, 0, 2, 0, 0,   0, 'x', 0,
                           0, 0, 0x07,   0, 8,    0, 2, 0, 0, 0, 'x', 0, 0,   0});
  list.insert(list.end(), parameter.begin(), parameter.end());
  list.insert(list.end(), {1, 0, 0, 0});
  return list;
}

/// A packet of a sender with one submessage.
Packet packet_of(const Packet& prefix, std::uint8_t kind, std::uint8_t flags, const Packet& body) {
  Packet packet = {'R', 'T', 'P', 'S', 2, 2, 1, 15};
  packet.insert(packet.end(), prefix.begin(), prefix.end());
  packet.insert(packet.end(), {kind, flags, static_cast<std::uint8_t>(body.size()),
                               static_cast<std::uint8_t>(body.size() >> 8U)});
  packet.insert(packet.end(), body.begin(), body.end());
  return packet;
}

// Each of these made Fast DDS 2.9.1 exit, hang, or take memory without limit. Services know the
// stranger, because any participant may announce itself.
TEST_F(GarbageTest, WhatKilledAParserIsRefused) {
  Packet stranger = start_and_listen().front();
  const Packet prefix = {1, 15, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9};
  rename_sender(stranger, prefix);
  // A partition of a thousand million characters, as many data representations, statistics that are
  // not at the end, a first sample 2^39.
  const std::vector<Packet> lists = {
      announced_writer(prefix, 1, {0x29, 0, 12, 0, 2, 0, 0, 0, 0, 0, 0, 0x40, 'x', 0, 0, 0}),
      announced_writer(prefix, 2, {0x73, 0, 8, 0, 0, 0, 0, 0x40, 0, 0, 0, 0}),
      announced_writer(prefix, 3, {0x06, 0x80, 8, 0, 0, 0, 0, 0x40, 0, 0, 0, 0}),
  };
  std::vector<Packet> packets;
  for (std::size_t n = 0; n < lists.size(); ++n) {
    Packet body = {
        0, 0, 16, 0, 0, 0, 3, 0xc7, 0, 0, 3, 0xc2, 0, 0, 0, 0, static_cast<std::uint8_t>(n + 1),
        0, 0, 0};
    body.insert(body.end(), lists[n].begin(), lists[n].end());
    packets.push_back(packet_of(prefix, 0x15, 0x05, body));
  }
  Packet statistics = packet_of(prefix, 0x80, 1, Packet(56, 0));
  statistics.insert(statistics.end(), {0x01, 1, 4, 0, 0, 0, 0, 0});
  packets.push_back(statistics);
  packets.push_back(
      packet_of(prefix, 0x07, 1, {0, 0, 3,    0xc7, 0, 0, 3, 0xc2, 0x80, 0, 0, 0, 0, 0,
                                  0, 0, 0x80, 0,    0, 0, 0, 0,    0,    0, 1, 0, 0, 0}));
  std::size_t rounds = 0;
  EXPECT_TRUE(wait_for(
      "the map store to count what is dropped",
      [&] { return rounds >= 10 && drops_["map_store: invalid_packet"] > 0; },
      [&] {
        keep_running();
        for (std::size_t port = 0; port < 16; ++port) {
          send(stranger, port);
          for (const Packet& packet : packets) send(packet, port);
        }
        ++rounds;
        pace();
      }));
  finish();
}

}  // namespace
}  // namespace topogeo::test
