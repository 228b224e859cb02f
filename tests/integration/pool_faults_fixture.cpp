#include "pool_faults_fixture.hpp"

#include <algorithm>
#include <csignal>
#include <iostream>
#include <random>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/topics.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/scan/carmen_log_writer.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::test {

using std::chrono::milliseconds;

namespace {

constexpr std::size_t kScans = 330;
/// Largest number of stops pending at the localizer while the run goes on.
constexpr std::size_t kBacklog = 8;

messaging::ParticipantOptions own_options() {
  std::random_device device;
  messaging::ParticipantOptions options;
  options.domain = static_cast<std::uint32_t>(std::stoul(own_domain()));
  options.partition = "faults-" + std::to_string(device()) + std::to_string(device());
  options.name = "test";
  return options;
}

}  // namespace

Drive::Drive(const Scratch& scratch) : log_(scratch / "log.clf.gz"), out_(scratch / "expected") {
  const auto world = std::filesystem::path(TOPOGEO_SHARE) / "worlds/floor.world.yaml";
  scan::CarmenLogWriter writer(log_);
  const auto simulated = simulation::simulate_log(world::load_world(world), {});
  for (std::size_t i = 0; i < std::min(kScans, simulated.scans.size()); ++i) {
    writer.write(simulated.scans[i]);
  }
  writer.close();
  scan::CarmenLogReader reader(log_);  // a log rounds the simulated values
  while (auto scan = reader.next()) scans_.push_back(std::move(*scan));
  Program map(scratch, "topogeo", {"map", "--log", log_, "--out", out_.string()});
  if (map.wait() != 0) throw std::runtime_error("topogeo map: " + map.err());
  for (const topomap::LocalMap& local : storage::read_map_file(out_ / "map.pb").local_maps) {
    stop_scans_.push_back(local.sequence);
  }
}

std::size_t Drive::stops_of(std::size_t scans) const {
  return static_cast<std::size_t>(std::ranges::lower_bound(stop_scans_, scans) -
                                  stop_scans_.begin());
}

std::string Drive::expected(const std::string& file) const {
  return read_file(out_ / file);
}

double Drive::expected_tasks() const {
  return nlohmann::json::parse(expected("report.json"))["counts"]["matches_tried"];
}

ServiceRun::ServiceRun(const Scratch& scratch, const Drive& drive, const std::string& name)
    : scratch_(scratch),
      drive_(drive),
      out_(scratch / name),
      options_(own_options()),
      participant_(options_),
      scan_writer_(participant_, messaging::kReplayRole),
      end_writer_(participant_),
      segments_in_(participant_),
      ends_in_(participant_),
      statuses_in_(participant_),
      workers_in_(participant_) {
  loop_.add<msg::TrajectorySegment>(segments_in_, [this](const auto& segment, const auto&) {
    stops_ = std::max(stops_, std::size_t{segment.total_stops()});
  });
  loop_.add<msg::StreamEnd>(ends_in_, [this](const msg::StreamEnd& end, const auto&) {
    ended_ = ended_ || end.stage() == msg::kStageMapStore;
  });
  loop_.add<msg::ServiceStatus>(statuses_in_, [this](const auto& status, const auto&) {
    if (status.service() == "localizer") status_ = status;
  });
  loop_.add<msg::WorkerStatus>(workers_in_, [this](const auto& status, const auto&) {
    workers_[static_cast<pid_t>(status.process_id())] = status;
  });
  const auto start = [&](const std::string& service, std::vector<std::string> words) {
    const std::vector<std::string> common = flags();
    words.insert(words.end(), common.begin(), common.end());
    services_.push_back(std::make_unique<Program>(scratch, service, words));
    return services_.back().get();
  };
  start("map_store", {"--out", out_.string(), "--title",
                      std::filesystem::path(drive.log()).filename().string()});
  start("local_mapper", {"--replay", "--standalone"});
  localizer_ = start("localizer", {"--standalone"});
  if (!scan_writer_.wait_for_matched(1, kFaultPatience) ||
      !wait_until([this] { return status_.state() == msg::kServiceWaiting; })) {
    throw std::runtime_error("the services do not start");
  }
}

ServiceRun::~ServiceRun() {
  const auto end = [](auto& programs) {
    for (const auto& program : programs) program->send_signal(SIGTERM);
    for (const auto& program : programs) {
      EXPECT_NO_THROW(program->wait()) << "a program does not end";
    }
  };
  end(own_workers_);
  end(services_);
}

std::vector<std::string> ServiceRun::flags() const {
  return {"--domain", std::to_string(options_.domain), "--partition", options_.partition};
}

Program& ServiceRun::start_worker(const std::string& name) {
  std::vector<std::string> words = flags();
  words.insert(words.end(), {"--name", name});
  own_workers_.push_back(std::make_unique<Program>(scratch_, "ga_worker", words));
  return *own_workers_.back();
}

// --- progress of the run

void ServiceRun::step() {
  // Not by received maps: a mapper with little CPU time would then get all scans at once.
  const bool has_room = drive_.stops_of(next_scan_) < stops_ + kBacklog;
  if (next_scan_ < drive_.scans().size() && has_room) send_scan();
  loop_.run_for(milliseconds(1));
}

void ServiceRun::send_scan() {
  const auto message = service::to_msg(drive_.scans()[next_scan_], "robot");
  if (scan_writer_.write(message)) ++next_scan_;  // otherwise the mapper is slow
}

bool ServiceRun::go_on_until(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + kFaultPatience;
  while (!condition() && std::chrono::steady_clock::now() < end) step();
  return condition();
}

bool ServiceRun::go_on_until_stop(std::size_t stop) {
  return go_on_until([&] { return stops_ >= stop; });
}

bool ServiceRun::finish() {
  const bool all_sent = go_on_until([this] { return next_scan_ == drive_.scans().size(); });
  if (!all_sent || !scan_writer_.wait_for_acknowledgments(kFaultPatience)) return false;
  msg::StreamEnd end;
  messaging::set_header(end, "robot", drive_.scans().back().stamp_ns, 0);
  end.stage(msg::kStageGateway);
  end.count(next_scan_);
  end.last_id(next_scan_ - 1);
  if (!end_writer_.write(end)) return false;
  return wait_until([this] { return ended_ && status_.state() == msg::kServiceFinished; });
}

bool ServiceRun::wait_until(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + kFaultPatience;
  while (!condition() && std::chrono::steady_clock::now() < end) loop_.run_for(milliseconds(1));
  return condition();
}

bool ServiceRun::wait_for_workers(std::size_t count) {
  return wait_until([&] { return counter("workers") == static_cast<double>(count); });
}

bool ServiceRun::wait_until_idle() {
  if (!scan_writer_.wait_for_acknowledgments(kFaultPatience)) return false;
  return wait_until([this] {
    return stops_ == drive_.stops_of(next_scan_) && counter("stops") == double(stops_);
  });
}

// --- its status

double ServiceRun::counter(const std::string& name) const {
  for (const msg::Counter& counter : status_.counters()) {
    if (counter.name().to_string() == name) return counter.value();
  }
  return -1.0;
}

std::uint64_t ServiceRun::faults(const std::string& reason) const {
  for (const msg::FaultCount& fault : status_.faults()) {
    if (fault.reason().to_string() == reason) return fault.count();
  }
  return 0;
}

std::uint64_t ServiceRun::tasks_done(const Program& worker) const {
  const auto found = workers_.find(worker.pid());
  return found == workers_.end() ? 0 : found->second.tasks_done();
}

double ServiceRun::uptime_s(const Program& worker) const {
  const auto found = workers_.find(worker.pid());
  return found == workers_.end() ? -1.0 : found->second.uptime_s();
}

void ServiceRun::expect_same_results() {
  for (const char* file : {"trajectory.tum", "map.pb"}) {
    const std::string expected = drive_.expected(file);
    EXPECT_FALSE(expected.empty());
    // No EXPECT_EQ: it would print megabytes.
    EXPECT_TRUE(read_file(out_ / file) == expected)
        << file << " differs from that of the run in one process; log of the localizer: " << log();
  }
  EXPECT_EQ(counter("tasks"), drive_.expected_tasks());
}

void ServiceRun::report_recovery() {
  const double recovery_ms = counter("longest_recovery_ms");
  EXPECT_GT(recovery_ms, 0.0) << log();
  std::cout << "recovered within " << recovery_ms << " ms\n";
  testing::Test::RecordProperty("recovery_ms", std::to_string(recovery_ms));
}

}  // namespace topogeo::test
