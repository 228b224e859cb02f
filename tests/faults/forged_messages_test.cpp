// A stranger without a key takes the name of a peer: "it has left", "its writer has left", "its
// lease is 4 ms". No link may be lost, with security and without; forged messages are counted.
#include "forged_messages.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/strangers.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/types.h"

#include "program.hpp"

namespace topogeo::test {
namespace {

using messaging::Event;
using messaging::EventKind;
using messaging::RemoteEndpoint;

unsigned volleys() {
  return std::getenv("TOPOGEO_ALL_FAULTS") != nullptr ? 100 : 5;
}

/// Two services in one process that send each other messages.
class ForgedMessagesTest : public testing::Test {
 protected:
  ForgedMessagesTest() {
    to_.sin_family = AF_INET;
    ::inet_pton(AF_INET, "127.0.0.1", &to_.sin_addr);
  }
  ForgedMessagesTest(const ForgedMessagesTest&) = delete;
  ForgedMessagesTest& operator=(const ForgedMessagesTest&) = delete;
  ~ForgedMessagesTest() override { ::close(socket_); }

  /// Makes keys for both. False without openssl.
  bool make_keys() {
    keys_ = scratch_ / "keys/robot";
    return issue_keys(scratch_ / "keys", "--robot robot robot sensor_gateway local_mapper");
  }

  /// Starts both, with their keys if there are any, and waits until they are connected.
  void connect() {
    announcements_ = std::make_unique<Announcements>(first_port_);
    gateway_ = std::make_unique<Side>(options("sensor_gateway"));
    mapper_ = std::make_unique<Side>(options("local_mapper"));
    ASSERT_TRUE(wait("both to be connected",
                     [this] { return gateway_->hears(*mapper_) && mapper_->hears(*gateway_); }));
  }

  messaging::ParticipantOptions options(const std::string& name) {
    messaging::ParticipantOptions options;
    options.domain = static_cast<std::uint32_t>(std::stoul(domain_));
    options.name = options.identity = name;
    options.security = keys_;
    options.observe = true;
    return options;
  }

  /// Each side sends statuses and counts those of the other one.
  struct Side {
    explicit Side(const messaging::ParticipantOptions& options)
        : name(options.name), participant(options), writer(participant), reader(participant) {
      loop.on_event([this](const Event& event) {
        if (event.kind == EventKind::kUnmatched) ++lost_links;
      });
      loop.add<msg::ServiceStatus>(
          reader, [this](const msg::ServiceStatus& got, const messaging::SampleInfo&) {
            last[got.service().to_string()] = got.sequence_number();
          });
      loop.add(writer);
      messaging::set_header(status, "robot", 1'000, 0);
      messaging::set_service(status, name, name);
    }

    void send() {
      status.sequence_number(status.sequence_number() + 1);
      static_cast<void>(writer.write(status));
    }

    bool hears(const Side& other) {
      const auto found = last.find(other.name);
      return found != last.end() && found->second > 0;
    }

    /// The other side's writers or readers that this side has discovered.
    std::vector<messaging::Handle> endpoints(bool writers) const {
      std::vector<messaging::Handle> found;
      for (const RemoteEndpoint& endpoint : participant.discovered()) {
        if (endpoint.writer == writers) found.push_back(endpoint.id);
      }
      return found;
    }

    std::string name;
    messaging::Participant participant;
    messaging::Writer<msg::ServiceStatus> writer;
    messaging::Reader<msg::ServiceStatus> reader;
    messaging::EventLoop loop;
    msg::ServiceStatus status;
    std::map<std::string, std::uint64_t> last;
    int lost_links = 0;
  };

  template <class Condition>
  bool wait(const std::string& what, const Condition& condition) {
    return wait_for(what, condition, [this] {
      for (Side* side : {gateway_.get(), mapper_.get()}) {
        side->send();
        static_cast<void>(side->loop.run_for(std::chrono::milliseconds(5)));
      }
    });
  }

  /// Sends to each discovery port that a participant of a host may have.
  void send(const Packet& packet) {
    constexpr std::uint16_t kParticipants = 16;
    for (std::uint16_t number = 0; number < kParticipants; ++number) {
      to_.sin_port = htons(static_cast<std::uint16_t>(first_port_ + 10 + 2 * number));
      ::sendto(socket_, packet.data(), packet.size(), 0,
               reinterpret_cast<const sockaddr*>(&to_),  // NOLINT: their interface
               sizeof to_);
    }
  }

  /// Forges the removal of both, and waits until one is counted as forged.
  void forge_removals() {
    const std::uint64_t before = messaging::stranger_counts().forged_removals;
    for (Side* side : {gateway_.get(), mapper_.get()}) {
      for (const Packet& packet : forged_by(*side).removals_of_participant()) send(packet);
    }
    ASSERT_TRUE(wait("the removals to be counted", [&] {
      return messaging::stranger_counts().forged_removals > before || lost_links() > 0;
    }));
  }

  [[nodiscard]] int lost_links() const { return gateway_->lost_links + mapper_->lost_links; }

  /// Forged in the name of the peer of `side`.
  ForgedMessages& forged_by(const Side& side) {
    auto& forged = forged_[side.name];
    if (!forged) forged = std::make_unique<ForgedMessages>(side.endpoints(true).at(0));
    return *forged;
  }

  void expect_all_links() {
    ASSERT_EQ(lost_links(), 0);
    const std::uint64_t sent = gateway_->status.sequence_number();
    EXPECT_TRUE(wait("messages both ways", [&] {
      return mapper_->last[gateway_->name] > sent && gateway_->last[mapper_->name] > sent;
    }));
  }

  Scratch scratch_;
  const std::string domain_ = own_domain();
  const std::uint16_t first_port_ = static_cast<std::uint16_t>(7400 + 250 * std::stoul(domain_));
  std::filesystem::path keys_;
  std::unique_ptr<Announcements> announcements_;
  std::unique_ptr<Side> gateway_;
  std::unique_ptr<Side> mapper_;
  std::map<std::string, std::unique_ptr<ForgedMessages>> forged_;

 private:
  int socket_ = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to_{};
};

TEST_F(ForgedMessagesTest, PlainPeersStayConnectedWhenSomebodySaysTheyHaveLeft) {
  connect();
  for (unsigned volley = 0; volley < volleys() && lost_links() == 0; ++volley) forge_removals();
  expect_all_links();
}

TEST_F(ForgedMessagesTest, AuthenticatedPeersStayConnectedWhenSomebodySaysTheyHaveLeft) {
  if (!make_keys()) GTEST_SKIP() << "openssl is missing";
  connect();
  for (unsigned volley = 0; volley < volleys() && lost_links() == 0; ++volley) forge_removals();
  expect_all_links();
}

TEST_F(ForgedMessagesTest, NobodyElseShortensTheLeaseOfAPeer) {
  connect();
  ForgedMessages& forged = forged_by(*mapper_);
  Packet announcement;
  while (!forged.sent(announcement)) announcement = announcements_->next();
  const std::vector<Packet> leases = forged.short_leases(announcement);
  ASSERT_EQ(leases.size(), 2U);
  for (const Packet& packet : leases) {
    send(packet);
    // Packets are read in order: when these are counted, the one before was read.
    forge_removals();
  }
  expect_all_links();
}

TEST_F(ForgedMessagesTest, PlainMessagesDoNotRemoveAProtectedReaderOrWriter) {
  if (!make_keys()) GTEST_SKIP() << "openssl is missing";
  connect();
  for (unsigned volley = 0; volley < volleys() && lost_links() == 0; ++volley) {
    ForgedMessages& forged = forged_by(*mapper_);
    const std::uint64_t before = messaging::stranger_counts().unprotected_packets;
    const messaging::Handle writer = mapper_->endpoints(true).at(0);
    const messaging::Handle reader = mapper_->endpoints(false).at(0);
    for (const bool enveloped : {false, true}) {
      const auto send_packet = [&](const Packet& packet) {
        send(enveloped ? ForgedMessages::in_dummy_envelope(packet) : packet);
      };
      send_packet(forged.other_topic_of(writer));
      send_packet(forged.removal_of_endpoint(writer, kOfWriters));
      send_packet(forged.removal_of_endpoint(reader, kOfReaders));
    }
    constexpr std::uint64_t kForged = 6;
    ASSERT_TRUE(wait("the messages to be refused", [&] {
      return messaging::stranger_counts().unprotected_packets >= before + kForged ||
             lost_links() > 0;
    }));
  }
  expect_all_links();
}

// A leaving peer disposes of its readers and writers, which takes effect at once.
TEST_F(ForgedMessagesTest, APeerThatLeavesIsDisconnectedAtOnce) {
  connect();
  const std::uint64_t before = messaging::stranger_counts().forged_removals;
  auto leaving = std::make_unique<Side>(options("leaving"));
  ASSERT_TRUE(wait("the third one", [&] {
    leaving->send();
    return mapper_->hears(*leaving);
  }));
  const std::size_t endpoints = mapper_->participant.discovered().size();
  leaving.reset();
  EXPECT_TRUE(wait("its reader and its writer to go",
                   [&] { return mapper_->participant.discovered().size() == endpoints - 2; }));
  EXPECT_EQ(messaging::stranger_counts().forged_removals, before);
}

}  // namespace
}  // namespace topogeo::test
