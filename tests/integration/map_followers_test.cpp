// Twenty programs follow the map of a robot while its map store adds to it, moves it, deletes from
// it, is killed and restarted. Some join late, lose messages, sleep or restart themselves. In the
// end each holds the store's map.
#include <csignal>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#if __has_include(<fastdds/rtps/transport/test_UDPv4TransportDescriptor.h>)
#include <fastdds/rtps/transport/test_UDPv4TransportDescriptor.h>
#else
#include <fastdds/rtps/transport/test_UDPv4TransportDescriptor.hpp>
#endif

#include "topogeo/map_client/map_reader.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/read_map.hpp"

#include "program.hpp"
#include "services/common/random_values.hpp"
#include "stored_drive.hpp"

namespace topogeo::test {
namespace {

using std::chrono::milliseconds;

/// A participant that loses outgoing messages, above all acknowledgements, and has no room for a
/// burst of incoming ones.
eprosima::fastdds::dds::DomainParticipant* lossy_participant() {
  namespace dds = eprosima::fastdds::dds;
  constexpr std::uint8_t kLostAcknowledgements = 30;  // per cent
  constexpr std::uint32_t kBuffer = 4096;             // bytes, a few messages
  const auto transport = std::make_shared<eprosima::fastdds::rtps::test_UDPv4TransportDescriptor>();
  transport->dropAckNackMessagesPercentage = kLostAcknowledgements;
  transport->receiveBufferSize = kBuffer;
  dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(transport);
  return dds::DomainParticipantFactory::get_instance()->create_participant(
      static_cast<std::uint32_t>(std::stoul(own_domain())), qos);
}

class Subscriber {
 public:
  enum class Kind : std::uint8_t { kSteady, kLate, kLossy, kSleeping, kRestarting };

  Subscriber(Kind kind, const std::string& partition) : kind_(kind) {
    options_.domain = static_cast<std::uint32_t>(std::stoul(own_domain()));
    options_.partition = partition;
    if (kind == Kind::kLossy) options_.participant = lossy_participant();
  }
  Subscriber(const Subscriber&) = delete;
  Subscriber& operator=(const Subscriber&) = delete;
  ~Subscriber() {
    stop();
    if (options_.participant == nullptr) return;
    eprosima::fastdds::dds::DomainParticipantFactory::get_instance()->delete_participant(
        options_.participant);
  }

  [[nodiscard]] Kind kind() const { return kind_; }
  void start() { reader_ = std::make_unique<map_client::MapReader>(options_); }
  void stop() { reader_.reset(); }
  void sleep() { asleep_ = true; }
  void wake() { asleep_ = false; }
  void work() {
    if (reader_ && !asleep_) static_cast<void>(reader_->wait(milliseconds(0)));
  }
  [[nodiscard]] map_client::MapReader& reader() { return *reader_; }
  /// Whether it has the map of a version, and nothing of a newer one.
  [[nodiscard]] bool has(std::uint64_t version) const {
    return reader_ && reader_->is_current() && reader_->map()->version == version;
  }

 private:
  Kind kind_;
  map_client::MapReaderOptions options_;
  std::unique_ptr<map_client::MapReader> reader_;
  bool asleep_ = false;
};

class MapFollowers : public testing::Test {
 protected:
  using Kind = Subscriber::Kind;

  MapFollowers() {
    for (const Kind kind :
         {Kind::kSteady, Kind::kLate, Kind::kLossy, Kind::kSleeping, Kind::kRestarting}) {
      for (int i = 0; i < 4; ++i) {
        subscribers_.push_back(std::make_unique<Subscriber>(kind, partition_));
      }
    }
  }

  template <class Action>
  void each(Kind kind, Action action) {
    for (const auto& subscriber : subscribers_) {
      if (subscriber->kind() == kind) action(*subscriber);
    }
  }
  /// Waits until the first subscriber, which is always there, has the map of a version.
  void wait_for(std::uint64_t version) {
    ASSERT_TRUE(eventually([&] { return subscribers_.front()->has(version); })) << version;
  }
  bool eventually(const std::function<bool()>& done) {
    return drive_.wait_until("the followers", [&] {
      for (const auto& subscriber : subscribers_) subscriber->work();
      count_changes();
      return done();
    });
  }
  void count_changes() {
    for (const map_client::Change& change : subscribers_.front()->reader().take_changes()) {
      if (!change.now) {
        ++removed_;
      } else if (change.before) {
        ++moved_;
      }
    }
  }
  /// `topogeo follow`.
  std::unique_ptr<Program> follow(std::vector<std::string> words) const {
    words.insert(words.begin(), "follow");
    words.insert(words.end(), {"--domain", own_domain(), "--partition", partition_});
    return std::make_unique<Program>(scratch_, "topogeo", words);
  }
  std::unique_ptr<Program> store() {
    return std::make_unique<Program>(
        scratch_, "map_store",
        std::vector<std::string>{"--out", (scratch_ / "out").string(), "--domain", own_domain(),
                                 "--partition", partition_});
  }

  const bool udp_only_ = (use_udp_only(), true);
  std::string partition_ = "followers" + std::to_string(std::random_device{}());
  Scratch scratch_;
  StoredDrive drive_{own_domain(), partition_, "floor"};
  std::vector<std::unique_ptr<Subscriber>> subscribers_;
  int removed_ = 0;
  int moved_ = 0;
};

TEST_F(MapFollowers, EndWithExactlyWhatTheStoreHolds) {
  constexpr double kBend_rad = 0.02;  // a metre at the end of fifty stops
  const std::size_t part = drive_.stops() / 4;
  for (const auto& subscriber : subscribers_) {
    if (subscriber->kind() != Kind::kLate) subscriber->start();
  }
  std::unique_ptr<Program> first = store();
  drive_.send(part);
  wait_for(part);

  each(Kind::kSleeping, [](Subscriber& subscriber) { subscriber.sleep(); });
  each(Kind::kRestarting, [](Subscriber& subscriber) { subscriber.stop(); });
  drive_.send(2 * part, kBend_rad);
  wait_for(2 * part);
  ASSERT_TRUE(drive_.wait_for_stored(2 * part));

  first->send_signal(SIGKILL);
  ASSERT_EQ(first->wait(), 128 + SIGKILL);
  each(Kind::kRestarting, [](Subscriber& subscriber) { subscriber.start(); });
  first = store();
  drive_.send(3 * part, -kBend_rad);
  wait_for(3 * part);

  each(Kind::kLate, [](Subscriber& subscriber) { subscriber.start(); });
  each(Kind::kRestarting, [](Subscriber& subscriber) {
    subscriber.stop();
    subscriber.start();
  });
  drive_.finish();
  first->wait_for_error_text("local maps, ");  // the final line
  each(Kind::kSleeping, [](Subscriber& subscriber) { subscriber.wake(); });

  const topomap::GlobalMap stored = storage::read_map(scratch_ / "out" / "map.sqlite").global_map;
  const auto holds = [&](const std::unique_ptr<Subscriber>& subscriber) {
    return subscriber->has(stored.version) &&
           service::from_elements(*subscriber->reader().map()) == stored;
  };
  EXPECT_TRUE(eventually([&] { return std::ranges::all_of(subscribers_, holds); }));
  const map_client::Map& of_first = *subscribers_.front()->reader().map();
  for (std::size_t i = 0; i < subscribers_.size(); ++i) {
    EXPECT_TRUE(holds(subscribers_[i])) << i;
    const map_client::Map& map = *subscribers_[i]->reader().map();
    EXPECT_EQ(map.map_id, drive_.map().map_id) << i;
    EXPECT_EQ(map.stamp_ns, of_first.stamp_ns) << i;
    const auto same = [](const auto& a, const auto& b) {
      return a.first == b.first && *a.second == *b.second;  // all fields as sent
    };
    EXPECT_TRUE(std::ranges::equal(map.nodes, of_first.nodes, same)) << i;
    EXPECT_TRUE(std::ranges::equal(map.branches, of_first.branches, same)) << i;
  }
  const auto file = scratch_ / "map.graphml";
  const auto shown = follow({"--once", "--json", "--out", file.string()});
  EXPECT_EQ(shown->wait(), 0) << shown->err();
  EXPECT_THAT(shown->out(), testing::HasSubstr(R"("event":"added","kind":"node","id":)"));
  EXPECT_THAT(shown->out(),
              testing::HasSubstr("\"nodes\":" + std::to_string(stored.nodes.size()) + "," +
                                 "\"branches\":" + std::to_string(stored.branches.size()) + "}\n"));
  EXPECT_THAT(read_file(file), testing::HasSubstr("</graphml>"));
  EXPECT_GT(removed_, 0);
  EXPECT_GT(moved_, 0);
  EXPECT_GT(stored.nodes.size(), 10U);
}

/// The example of docs/follow_map.md, on the domain of the environment.
class EnvironmentDomain {
 public:
  EnvironmentDomain() { ::setenv("TOPOGEO_DOMAIN", own_domain().c_str(), 1); }
  EnvironmentDomain(const EnvironmentDomain&) = delete;
  EnvironmentDomain& operator=(const EnvironmentDomain&) = delete;
  ~EnvironmentDomain() { ::unsetenv("TOPOGEO_DOMAIN"); }
};

TEST_F(MapFollowers, HearEveryPartitionUnlessOneIsNamed) {
  const EnvironmentDomain domain;
  const std::unique_ptr<Program> running = store();
  drive_.send(4);
  drive_.finish();
  running->wait_for_error_text("local maps, ");  // the final line
  Program all(scratch_, "topogeo", {"follow", "--once"});
  EXPECT_EQ(all.wait(), 0) << all.err();
  EXPECT_THAT(all.out(), testing::HasSubstr(" branches\n"));

  map_client::MapReader reader;
  EXPECT_TRUE(drive_.wait_until("the map in all partitions", [&] {
    static_cast<void>(reader.wait(milliseconds(0)));
    return reader.map() != nullptr;
  }));

  Program other(scratch_, "topogeo", {"follow", "--partition", "other"});
  other.wait_for_error_text("no map store of robot 'robot' is alive on domain " + own_domain());
  EXPECT_THAT(other.err(), testing::HasSubstr("partition '" + partition_ + "' (robot 'robot')"));
  Program recorder(scratch_, "topogeo",
                   {"record", "--partition", "other", "--out", scratch_ / "x.clf"});
  recorder.wait_for_error_text("no sensor gateway of robot 'robot' is alive");
  EXPECT_THAT(recorder.err(), testing::HasSubstr("partition '" + partition_ + "'"));
}

TEST_F(MapFollowers, WithoutAStoreTheCommandWaitsUntilItIsStopped) {
  for (const bool once : {false, true}) {
    const auto waiting =
        follow(once ? std::vector<std::string>{"--once"} : std::vector<std::string>{});
    waiting->wait_for_error_text("waiting for a map store of robot 'robot'");
    waiting->send_signal(SIGINT);
    EXPECT_EQ(waiting->wait(), once ? 128 + SIGINT : 0) << waiting->err();
    EXPECT_EQ(waiting->out(), "");
  }
  EXPECT_EQ(follow({"--out", "map.png"})->wait(), 2);
}

}  // namespace
}  // namespace topogeo::test
