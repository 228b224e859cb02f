// A log is read again for a local mapper that was away: the gateway's output, and the mapper's
// behaviour when the source of the scans cannot go back.
#include <chrono>
#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/topics.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/status.h"
#include "topogeo/msg/stream.h"

#include "join.hpp"
#include "program.hpp"
#include "waiting.hpp"

namespace topogeo::test {
namespace {

constexpr const char* kLogPartition = "log-gateway-test";

template <class Condition>
bool wait_in(messaging::EventLoop& loop, const Condition& condition) {
  return test::wait_for("messages of the programs", condition,
                        [&] { loop.run_for(std::chrono::milliseconds(5)); });
}

/// The test takes the place of the local mapper.
class LogReadAgain : public testing::Test {
 protected:
  LogReadAgain() {
    use_udp_only();
    write_log("room", scratch_ / "log.clf");
    loop_.add<msg::Scan>(
        scans_reader_,
        [this](const msg::Scan& scan, const messaging::SampleInfo&) { scans_.push_back(scan); });
    loop_.add<msg::Odometry>(odometry_reader_,
                             [this](const msg::Odometry& odometry, const messaging::SampleInfo&) {
                               odometry_.push_back(odometry);
                             });
    loop_.add<msg::StreamEnd>(
        ends_reader_,
        [this](const msg::StreamEnd& end, const messaging::SampleInfo&) { ends_.push_back(end); });
  }

  /// Starts the gateway and waits for the whole log.
  void read_all() {
    gateway_ = std::make_unique<Program>(
        scratch_, "sensor_gateway",
        std::vector<std::string>{"--domain", domain_, "--partition", kLogPartition, "--log",
                                 (scratch_ / "log.clf").string()});
    ASSERT_TRUE(wait_in(loop_, [&] {
      return ends_.size() == 1 && scans_.size() == ends_[0].count() &&
             odometry_.size() == scans_.size() && requests_.matched() > 0;
    })) << gateway_->err();
    ASSERT_GT(scans_.size(), 20U);
  }

  /// Scans after this request, up to the next end of the stream.
  std::vector<msg::Scan> ask(std::uint64_t odometry_epoch, std::uint64_t first) {
    scans_.clear();
    odometry_.clear();
    const std::size_t ends = ends_.size();
    msg::ScanRequest request;
    messaging::set_header(request, "robot", 0, ends);
    request.odometry_epoch(odometry_epoch);
    request.first_scan(first);
    EXPECT_TRUE(requests_.write(request));
    EXPECT_TRUE(wait_in(loop_, [&] {
      return ends_.size() > ends && !scans_.empty() &&
             scans_.back().sequence_number() + 1 == ends_.back().count() &&
             odometry_.size() == scans_.size();
    })) << gateway_->err();
    return scans_;
  }

  Scratch scratch_;
  std::string domain_ = own_domain();
  messaging::Participant participant_ = join(domain_, kLogPartition);
  messaging::Reader<msg::Scan> scans_reader_{
      participant_,
      {.role = std::string(messaging::kReplayRole), .read_with = {messaging::kOdometry}}};
  messaging::Reader<msg::Odometry> odometry_reader_{participant_,
                                                    {std::string(messaging::kReplayRole), {}}};
  messaging::Reader<msg::StreamEnd> ends_reader_{participant_};
  messaging::Writer<msg::ScanRequest> requests_{participant_};
  messaging::EventLoop loop_;
  std::vector<msg::Scan> scans_;
  std::vector<msg::Odometry> odometry_;
  std::vector<msg::StreamEnd> ends_;
  std::unique_ptr<Program> gateway_;
};

TEST_F(LogReadAgain, FromTheScanThatIsWanted) {
  read_all();
  const std::vector<msg::Scan> all = scans_;
  const std::vector<msg::Odometry> all_odometry = odometry_;
  const std::vector<msg::Scan> again = ask(all[0].odometry_epoch(), 12);
  ASSERT_EQ(again.size(), all.size() - 12);
  for (std::size_t i = 0; i < again.size(); ++i) {
    EXPECT_EQ(again[i], all[i + 12]) << i;
    EXPECT_EQ(odometry_[i], all_odometry[i + 12]) << i << ": the speed, too";
  }
  EXPECT_EQ(ends_.back().count(), all.size());
  EXPECT_EQ(ends_.back().sequence_number(), 1U);
}

TEST_F(LogReadAgain, AllOfItForWhoHasBegunAnotherLog) {
  read_all();
  const std::vector<msg::Scan> all = scans_;
  EXPECT_EQ(ask(all[0].odometry_epoch() + 1, 12), all);
  EXPECT_EQ(ask(0, 0), all);
}

TEST_F(LogReadAgain, TheLastScanForWhoHadAll) {
  read_all();
  const std::vector<msg::Scan> all = scans_;
  EXPECT_EQ(ask(all[0].odometry_epoch(), all.size()), std::vector{all.back()});
}

/// A program that announces its readers one after the other, with a delay that a test controls.
class LateLogReader : public testing::Test {
 protected:
  LateLogReader() {
    use_udp_only();
    write_log("room", scratch_ / "log.clf");
    loop_.add<msg::Scan>(scans_reader_,
                         [this](const msg::Scan& scan, const messaging::SampleInfo&) {
                           scans_.push_back(scan.sequence_number());
                         });
    loop_.add<msg::ServiceStatus>(
        status_reader_, [this](const msg::ServiceStatus& status, const messaging::SampleInfo&) {
          waits_for_ = status.waits_for().to_string();
        });
    loop_.add<msg::StreamEnd>(ends_reader_,
                              [this](const msg::StreamEnd& end, const messaging::SampleInfo&) {
                                scans_in_log_ = end.count();
                              });
  }

  void start_gateway(std::vector<std::string> words) {
    words.insert(words.end(), {"--domain", domain_, "--partition", kLogPartition, "--log",
                               (scratch_ / "log.clf").string()});
    gateway_ = std::make_unique<Program>(scratch_, "sensor_gateway", words);
  }
  /// Reads scans and odometry from now on until the log has ended, and returns the sequence numbers
  /// of the odometry.
  std::vector<std::uint64_t> read_odometry(const messaging::Participant& participant) {
    std::vector<std::uint64_t> odometry;
    const messaging::Reader<msg::Odometry> reader(participant,
                                                  {.role = std::string(messaging::kReplayRole)});
    messaging::EventLoop loop;
    loop.add<msg::Odometry>(reader, [&](const msg::Odometry& sample, const messaging::SampleInfo&) {
      odometry.push_back(sample.sequence_number());
    });
    EXPECT_TRUE(test::wait_for(
        "the whole log",
        [&] { return scans_in_log_ && odometry.size() >= scans_.size() && has_all_scans(); },
        [&] {
          loop.run_for(std::chrono::milliseconds(5));
          loop_.run_for(std::chrono::milliseconds(5));
        }))
        << gateway_->err();
    return odometry;
  }
  [[nodiscard]] bool has_all_scans() const { return scans_.size() == *scans_in_log_; }
  /// Waits until the gateway reports that it waits for `what`, or has sent scans instead.
  [[nodiscard]] bool wait_until_missed(const std::string& what) {
    return test::wait_for(
        "the gateway to miss " + what,
        [&] { return waits_for_.find(what) != std::string::npos || !scans_.empty(); },
        [&] { loop_.run_for(std::chrono::milliseconds(5)); });
  }

  Scratch scratch_;
  std::string domain_ = own_domain();
  messaging::Participant participant_ = join(domain_, kLogPartition);
  messaging::Reader<msg::Scan> scans_reader_{
      participant_,
      {.role = std::string(messaging::kReplayRole), .read_with = {messaging::kOdometry}}};
  messaging::Reader<msg::ServiceStatus> status_reader_{participant_};
  messaging::Reader<msg::StreamEnd> ends_reader_{participant_};
  messaging::EventLoop loop_;
  std::vector<std::uint64_t> scans_;
  std::optional<std::uint64_t> scans_in_log_;
  std::string waits_for_;
  std::unique_ptr<Program> gateway_;
};

TEST_F(LateLogReader, OfOdometryGetsAllOfIt) {
  start_gateway({});
  ASSERT_TRUE(wait_until_missed("not connected with odometry"));
  ASSERT_TRUE(scans_.empty());
  EXPECT_EQ(read_odometry(participant_), scans_);
  EXPECT_GT(scans_.size(), 20U);
}

TEST_F(LateLogReader, OfOdometryAloneIsWaitedForWhereItIsCounted) {
  const messaging::Participant other = join(domain_, kLogPartition);
  const messaging::Reader<msg::Odometry> own(participant_,
                                             {.role = std::string(messaging::kReplayRole)});
  loop_.add<msg::Odometry>(own, [](const msg::Odometry&, const messaging::SampleInfo&) {});
  start_gateway({"--odometry-readers", "2"});
  ASSERT_TRUE(wait_until_missed("2 readers of odometry"));
  ASSERT_TRUE(scans_.empty());
  EXPECT_EQ(read_odometry(other), scans_);
  EXPECT_GT(scans_.size(), 20U);
}

// The log file is gone, so there is nothing to go back to, but the gateway lives.
TEST_F(LogReadAgain, SaysWhyItCannotBeRead) {
  read_all();
  messaging::Reader<msg::ServiceStatus> status_reader(participant_);
  bool said = false;
  loop_.add<msg::ServiceStatus>(
      status_reader, [&](const msg::ServiceStatus& status, const messaging::SampleInfo&) {
        for (const msg::FaultCount& fault : status.faults()) {
          said = said || fault.reason().to_string() == "log cannot be read again";
        }
      });
  std::filesystem::remove(scratch_ / "log.clf");
  msg::ScanRequest request;
  messaging::set_header(request, "robot", 0, 0);
  ASSERT_TRUE(requests_.write(request));
  EXPECT_TRUE(wait_in(loop_, [&] { return said; })) << gateway_->err();
}

// All programs of a log whose map is finished. A mapper killed then has no work left.
TEST(LocalMapperOfALog, AsksOnceWhenAllIsMapped) {
  use_udp_only();
  const Scratch scratch;
  const std::string domain = own_domain();
  write_log("room", scratch / "log.clf");
  const messaging::Participant participant = join(domain, kLogPartition);
  const messaging::Reader<msg::StreamEnd> ends_reader(participant);
  const messaging::Reader<msg::ServiceStatus> status_reader(participant);
  messaging::EventLoop loop;
  bool mapped = false;
  std::uint64_t gateway_ends = 0;
  std::uint32_t finished = 0;  // process of the mapper that has finished
  double uptime_s = 0.0;       // its newest one
  loop.add<msg::StreamEnd>(ends_reader,
                           [&](const msg::StreamEnd& end, const messaging::SampleInfo&) {
                             mapped = mapped || end.stage() == msg::kStageMapStore;
                             if (end.stage() == msg::kStageGateway) ++gateway_ends;
                           });
  loop.add<msg::ServiceStatus>(
      status_reader, [&](const msg::ServiceStatus& status, const messaging::SampleInfo&) {
        if (status.service() == "local_mapper" && status.state() == msg::kServiceFinished) {
          finished = status.process_id();
          uptime_s = status.uptime_s();
        }
      });
  const auto start = [&](const std::string& service, std::vector<std::string> words) {
    words.insert(words.end(), {"--domain", domain, "--partition", kLogPartition});
    return std::make_unique<Program>(scratch, service, words);
  };
  const auto store = start("map_store", {"--out", (scratch / "out").string()});
  const auto localizer = start("localizer", {"--replay"});
  auto mapper = start("local_mapper", {"--replay"});
  const auto gateway = start("sensor_gateway", {"--log", (scratch / "log.clf").string()});
  ASSERT_TRUE(wait_in(loop, [&] { return mapped; })) << store->err() << mapper->err();
  mapper->send_signal(SIGKILL);
  mapper->wait();
  mapper = start("local_mapper", {"--replay"});
  const auto process = static_cast<std::uint32_t>(mapper->pid());
  ASSERT_TRUE(wait_in(loop, [&] { return finished == process; })) << mapper->err();
  const double finished_s = uptime_s;
  EXPECT_TRUE(wait_in(loop, [&] { return gateway_ends >= 2; }))
      << "the log was read again up to its last scan";
  // A request is repeated every two seconds until the scans come, and not after that.
  constexpr double kRepeated_s = 2.0;
  EXPECT_TRUE(wait_in(loop, [&] { return uptime_s > finished_s + kRepeated_s + 0.5; }));
  EXPECT_LE(gateway_ends, 2U + static_cast<std::uint64_t>(finished_s / kRepeated_s));
}

// The source of the scans does not know such requests.
TEST(LocalMapperOfALog, GoesOnWithoutTheScansThatNobodySendsAgain) {
  use_udp_only();
  const Scratch scratch;
  const std::string domain = own_domain();
  const messaging::Participant participant = join(domain, kLogPartition);
  messaging::Writer<msg::Scan> scans(participant, messaging::kReplayRole);
  const messaging::Reader<msg::ServiceStatus> status_reader(participant);
  messaging::EventLoop loop;
  std::string waits_for;
  std::vector<std::string> faults;
  double used = 0.0;
  loop.add<msg::ServiceStatus>(status_reader,
                               [&](const msg::ServiceStatus& status, const messaging::SampleInfo&) {
                                 if (!status.waits_for().to_string().empty())
                                   waits_for = status.waits_for().to_string();
                                 faults.clear();
                                 for (const auto& fault : status.faults())
                                   faults.push_back(fault.reason().to_string());
                                 for (const auto& counter : status.counters()) {
                                   if (counter.name() == "scans") used = counter.value();
                                 }
                               });
  const Program mapper(
      scratch, "local_mapper",
      {"--domain", domain, "--partition", kLogPartition, "--replay", "--standalone"});
  ASSERT_TRUE(wait_in(loop, [&] { return scans.matched() > 0; })) << mapper.err();
  msg::Scan scan;
  scan.angle_min_rad(-1.5);
  scan.angle_step_rad(0.01);
  scan.ranges_m().assign(300, 2.0F);
  std::uint64_t sent = 5;  // the first five are missing
  loop.add_timer(std::chrono::milliseconds(50), [&] {
    messaging::set_header(scan, "robot", static_cast<std::int64_t>(sent) * 100'000'000, sent);
    if (scans.write(scan)) ++sent;
  });
  EXPECT_TRUE(wait_in(loop, [&] { return used > 0.0; })) << mapper.err();
  EXPECT_THAT(waits_for, testing::HasSubstr("a resend of scan 0 of the log"));
  EXPECT_TRUE(wait_in(loop, [&] { return !faults.empty(); }));
  EXPECT_THAT(faults, testing::Each("scans missing"));
}

}  // namespace
}  // namespace topogeo::test
