// Strangers on the network of a run: participants that come and go, samples of absurd content,
// topics that do not exist, packets of garbage at the ports. The map must be that of one process,
// the memory of all services stays small, and what was refused is in their statuses.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <optional>
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
#include "topogeo/messaging/topics.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/types.h"

#include "garbage.hpp"
#include "program.hpp"
#include "stranger.hpp"
#include "waiting.hpp"

namespace topogeo::test {
namespace {

using std::chrono::milliseconds;

/// What any service may take after a long log.
constexpr std::size_t kMostMemoryMb = kTimeFactor == 1 ? 150 : 600;  // a sanitizer takes its own

/// Between two rounds of samples on all topics, so that strangers leave the run part of the
/// machine: nothing is measured by it. stranger_flood is who does not.
constexpr milliseconds kPeriod{20};

std::size_t memory_mb(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
  std::size_t all_pages = 0;
  std::size_t resident_pages = 0;
  file >> all_pages >> resident_pages;
  return resident_pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) >> 20U;
}

/// Holds back the log of a run: a reader that takes no scans, so that the gateway waits for it as
/// for any slow one.
class LogGate {
 public:
  /// `scans`: of the log.
  LogGate(const messaging::Participant& participant, std::uint64_t scans)
      : scans_(participant, {.role = std::string(messaging::kReplayRole)}),
        hold_at_(scans - kRoom) {}

  /// Another scan may be sent, up to those that would not hold the log back any more.
  void let_one_pass() {
    if (passed_ >= hold_at_) return;
    scans_.take(
        [this](const msg::Scan& scan, const messaging::SampleInfo& info) {
          if (!gateway_) gateway_ = info.writer;  // not a stranger, whom no test starts before
          if (info.valid && info.writer == *gateway_) passed_ = scan.sequence_number();
        },
        1);
  }
  /// A scan has come, and the rest of the log is longer than what is sent to a reader that takes
  /// none.
  [[nodiscard]] bool holds() const { return gateway_ && passed_ < hold_at_; }

 private:
  /// What both histories of role sensor_replay have room for, and some.
  static constexpr std::uint64_t kRoom = 300;

  messaging::Reader<msg::Scan> scans_;
  const std::uint64_t hold_at_;
  std::optional<messaging::Handle> gateway_;
  std::uint64_t passed_ = 0;
};

class StrangersTest : public testing::Test {
 protected:
  StrangersTest() {
    use_udp_only();
    simulation::SimulationOptions options;
    options.scan_step_m = 0.02;  // many scans, for the gate
    options.scan_step_rad = 0.03;
    write_log("room", scratch_ / "log.clf", {}, options);
    std::ifstream log(scratch_ / "log.clf");
    for (std::string line; std::getline(log, line);) scans_ += line.starts_with("FLASER") ? 1 : 0;
    Program map(scratch_, "topogeo",
                {"map", "--log", scratch_ / "log.clf", "--out", scratch_ / "alone"});
    EXPECT_EQ(map.wait(), 0) << map.err();
  }

  /// A run of the log that lasts until finish().
  void start() {
    Wait wait("a run that is held back");
    while (true) {
      start_at_rate("3");
      run_->wait_for_progress(5);
      // Not before, as the gateway takes it for one of those that work on the scans.
      gate_ = std::make_unique<LogGate>(participant_, scans_);
      while (!gate_->holds() && !run_->ended() && wait.goes_on()) {
        gate_->let_one_pass();
        std::this_thread::sleep_for(milliseconds(1));
      }
      if (gate_->holds()) return;
      gate_.reset();  // it came too late
      ASSERT_EQ(run_->wait(), 0) << run_->err();
      std::filesystem::remove_all(scratch_ / "out");
    }
  }
  void start_at_rate(const std::string& rate) {
    run_ = std::make_unique<Program>(
        scratch_, "topogeo",
        std::vector<std::string>{"run", "--log", scratch_ / "log.clf", "--out", scratch_ / "out",
                                 "--rate", rate, "--workers", "1", "--domain", domain_});
  }

  /// The highest memory of each service and the faults that any has reported, until it ends.
  void finish() {
    gate_.reset();
    EXPECT_EQ(run_->wait(), 0) << run_->err();
    EXPECT_TRUE(read_file(scratch_ / "out/map.pb") == read_file(scratch_ / "alone/map.pb"));
    EXPECT_LE(most_memory_mb_, kMostMemoryMb);
    RecordProperty("most_memory_mb", static_cast<int>(most_memory_mb_));
  }

  void look() {
    if (gate_) gate_->let_one_pass();
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

  /// At least `least` times, and until services have reported all of these.
  template <class Samples>
  void write_until_counted(Samples& samples, const std::vector<std::string>& reasons,
                           std::uint64_t least) {
    const auto counted = [this](const std::string& reason) { return faults_[reason] > 0; };
    Wait wait("services to report what they have refused");
    for (std::uint64_t i = 0; i < least || !std::ranges::all_of(reasons, counted); ++i) {
      ASSERT_TRUE(wait.goes_on() && !run_->services().empty())
          << testing::PrintToString(faults_) << testing::PrintToString(drops_) << run_->err();
      samples.write(i);
      std::this_thread::sleep_for(kPeriod);
      look();
    }
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
  std::uint64_t scans_ = 0;  // of the log
  std::unique_ptr<LogGate> gate_;
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
    look();
  }
  finish();
}

TEST_F(StrangersTest, SamplesOfAbsurdContentAreRefusedAndCounted) {
  start();
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

// With the devices, the navigator and a map that stays as it is.
TEST_F(StrangersTest, ADriveGoesOnAmongSamplesOfAbsurdContent) {
  run_ = std::make_unique<Program>(
      scratch_, "topogeo",
      std::vector<std::string>{"run", "--sim", std::string(TOPOGEO_TEST_DATA) + "/room.world.yaml",
                               "--map", scratch_ / "alone/map.pb", "--goto", "3,0", "--out",
                               scratch_ / "out", "--workers", "1", "--domain", domain_});
  AbsurdSamples samples(participant_, domain());
  for (std::uint64_t i = 0; !run_->ended(); ++i) {
    samples.write(i);
    std::this_thread::sleep_for(kPeriod);
    look();
  }
  EXPECT_EQ(run_->wait(), 0) << run_->err();
  EXPECT_THAT(run_->out(), testing::HasSubstr("arrived at 3,0"));
  EXPECT_THAT(run_->out(), testing::HasSubstr(" 0 collisions"));
  EXPECT_LE(most_memory_mb_, kMostMemoryMb);
  RecordProperty("most_memory_mb", static_cast<int>(most_memory_mb_));
  for (const char* reason :
       {"sensor_gateway: invalid motion command", "sensor_gateway: invalid limits",
        "simulator: invalid simulator command", "navigator: invalid goal",
        "navigator: invalid route", "navigator: invalid pose", "navigator: invalid odometry",
        "navigator: invalid scan", "navigator: invalid sonar", "navigator: invalid grid tile",
        "navigator: invalid hybrid map"}) {
    EXPECT_GT(faults_[reason], 0U) << reason << testing::PrintToString(faults_);
  }
}

TEST_F(StrangersTest, TopicsThatDoNotExistAreCounted) {
  start();
  UnknownTopics topics(domain());
  Wait wait("the planner to count topics that do not exist");
  while (topics.size() < 300 || drops_["planner: unknown_topic"] == 0) {
    ASSERT_TRUE(wait.goes_on() && !run_->services().empty()) << testing::PrintToString(drops_);
    topics.add();
    look();
  }
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

  /// Calls `start_run` and returns what the participants of the run announce.
  std::vector<Packet> listen_to(const std::function<void()>& start_run) const {
    Announcements announcements(first_port_);
    start_run();
    std::vector<Packet> real;
    Wait wait("participants to announce themselves");
    while (real.size() < 10) {
      if (!wait.goes_on()) throw std::runtime_error("nobody announces itself");
      Packet packet = announcements.next();
      if (packet.size() > 60) real.push_back(std::move(packet));
    }
    return real;
  }

  /// To one of the ports that the participants of a host have.
  void send(const Packet& packet, std::size_t number) {
    to_.sin_port = htons(static_cast<std::uint16_t>(first_port_ + 10 + number % 16));
    ::sendto(socket_, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to_),
             sizeof to_);  // NOLINT: their interface
  }

  void send_much(Garbage garbage) {
    for (std::size_t i = 0; i < 20'000; ++i) {
      send(garbage.next(), i);
      // More at once do not fit into the buffers of the sockets, and no service would read them.
      if (i % 20 == 0) std::this_thread::sleep_for(milliseconds(2));
      if (i % 500 == 0) look();
    }
    look();
  }

  const std::uint16_t first_port_ = static_cast<std::uint16_t>(7400 + 250 * std::stoul(domain_));

 private:
  int socket_ = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to_{};
};

TEST_F(GarbageTest, OfUnknownPeersIsDropped) {
  send_much(Garbage(listen_to([this] { start(); }), true));
  Wait wait("the localizer's next status");
  while (drops_["localizer: invalid_packet"] == 0) {
    ASSERT_TRUE(wait.goes_on() && !run_->services().empty()) << testing::PrintToString(drops_);
    static_cast<void>(statuses_.wait_for_data(milliseconds(100)));
    look();
  }
  finish();
}

// Without security whoever takes the name of a peer speaks for it, so the run need not end as it
// would. But no service dies, hangs or grows.
TEST_F(GarbageTest, InTheNameOfPeersKillsNoService) {
  // Its pace holds this run back: a gate is a peer, in whose name a stranger may open it.
  const std::vector<Packet> real = listen_to([this] {
    start_at_rate("0.001");
    run_->wait_for_progress(0);
  });
  const std::vector<pid_t> services = run_->services();
  send_much(Garbage(real, false));
  EXPECT_EQ(run_->services(), services) << run_->err();
  EXPECT_LE(most_memory_mb_, kMostMemoryMb);
  run_->send_signal(SIGINT);
  static_cast<void>(run_->wait());
}

/// A list of parameters of a writer, with one more.
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

// Each of these made Fast DDS 2.9.1 end the process, hang, or take memory without end. The stranger
// is one that the services know, as anybody may announce himself.
TEST_F(GarbageTest, WhatKilledAParserIsRefused) {
  Packet stranger = listen_to([this] { start(); }).front();
  const Packet prefix = {1, 15, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9};
  rename_sender(stranger, prefix);
  // A partition of a thousand million characters, as many data representations, statistics that
  // are not at the end, a first sample 2^39.
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
  Wait wait("the map store to report packets that it has refused");
  for (std::size_t round = 0; round < 10 || drops_["map_store: invalid_packet"] == 0; ++round) {
    ASSERT_TRUE(wait.goes_on() && !run_->services().empty()) << testing::PrintToString(drops_);
    for (std::size_t port = 0; port < 16; ++port) {
      send(stranger, port);
      for (const Packet& packet : packets) send(packet, port);
    }
    static_cast<void>(statuses_.wait_for_data(milliseconds(50)));
    look();
  }
  finish();
}

}  // namespace
}  // namespace topogeo::test
