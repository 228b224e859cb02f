// A gateway whose scans do not reach a local mapper, while each of the two believes that it is
// connected to the other. The mapper must detect that, end with the exit code for a restart by its
// supervisor, and work in its next life.
//
// This test is the gateway: the function below may drop the packets that it sends.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/status_publisher.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/status.h"
#include "topogeo/support/version.hpp"

#include "program.hpp"

namespace {

/// The packets of this process that are dropped. Thread-safe.
class Losses {
 public:
  void lose_scans(bool lost) { scans_ = lost; }
  /// Drops all packets to the ports used so far, except multicast.
  void lose_known_ports(bool lost) { ports_ = lost; }

  bool take(std::span<const std::uint8_t> packet, const sockaddr* address) {
    if (scans_ && has_scan(packet)) return true;
    if (address == nullptr || address->sa_family != AF_INET) return false;
    const auto& to = *reinterpret_cast<const sockaddr_in*>(address);  // NOLINT: its interface
    if (IN_MULTICAST(ntohl(to.sin_addr.s_addr))) return false;
    const std::lock_guard lock(mutex_);
    if (ports_) return known_.contains(to.sin_port);
    known_.insert(to.sin_port);
    return false;
  }

 private:
  /// All ranges are 2 m, a pattern that can be found in a packet.
  static bool has_scan(std::span<const std::uint8_t> packet) {
    constexpr std::array<std::uint8_t, 16> kRanges = {0, 0, 0, 0x40, 0, 0, 0, 0x40,
                                                      0, 0, 0, 0x40, 0, 0, 0, 0x40};
    const auto found = std::search(packet.begin(), packet.end(), kRanges.begin(), kRanges.end());
    return found != packet.end();
  }

  std::atomic<bool> scans_ = false;
  std::atomic<bool> ports_ = false;
  std::mutex mutex_;
  std::set<in_port_t> known_;
};

Losses& losses() {
  static auto* const losses = new Losses;  // NOLINT: threads of the middleware outlive statics
  return *losses;
}

}  // namespace

// Replaces the function of the C library, also for the middleware.
extern "C" ssize_t sendto(int socket, const void* packet, std::size_t size, int flags,
                          const sockaddr* address, socklen_t address_size) {
  using Function = ssize_t (*)(int, const void*, std::size_t, int, const sockaddr*, socklen_t);
  static const auto original = reinterpret_cast<Function>(::dlsym(RTLD_NEXT, "sendto"));
  const std::span bytes(static_cast<const std::uint8_t*>(packet), size);
  if (losses().take(bytes, address)) return static_cast<ssize_t>(size);
  return original(socket, packet, size, flags, address, address_size);
}

// The same for packets in parts.
extern "C" ssize_t sendmsg(int socket, const msghdr* message, int flags) {
  using Function = ssize_t (*)(int, const msghdr*, int);
  static const auto original = reinterpret_cast<Function>(::dlsym(RTLD_NEXT, "sendmsg"));
  std::vector<std::uint8_t> packet;
  for (const iovec& part : std::span(message->msg_iov, message->msg_iovlen)) {
    const auto* const first = static_cast<const std::uint8_t*>(part.iov_base);
    packet.insert(packet.end(), first, first + part.iov_len);
  }
  if (losses().take(packet, static_cast<const sockaddr*>(message->msg_name))) {
    return static_cast<ssize_t>(packet.size());
  }
  return original(socket, message, flags);
}

namespace topogeo::test {
namespace {

using testing::HasSubstr;

constexpr std::size_t kBeams = 181;
constexpr std::chrono::milliseconds kScanPeriod{100};

/// A room of 4 m, seen from its middle.
void fill(msg::Scan& scan) {
  scan.angle_min_rad(-1.570796326794897F);
  scan.angle_step_rad(0.017453292519943F);
  scan.ranges_m(std::vector<float>(kBeams, 2.0F));
}

class DeafnessTest : public testing::Test {
 protected:
  DeafnessTest() { use_udp_only(); }
  ~DeafnessTest() override {
    losses().lose_scans(false);
    losses().lose_known_ports(false);
    ::unsetenv("TOPOGEO_SECURITY");  // NOLINT(concurrency-mt-unsafe): one thread
  }

  /// False without openssl.
  bool make_keys() {
    ::setenv("TOPOGEO_SECURITY", (scratch_ / "keys/robot").c_str(), 1);  // NOLINT: one thread
    return issue_keys(scratch_ / "keys", "--robot robot robot sensor_gateway local_mapper");
  }

  void start_gateway() {
    messaging::ParticipantOptions options;
    options.domain = static_cast<std::uint32_t>(std::stoul(domain_));
    options.name = "robot/sensor_gateway";
    options.identity = "sensor_gateway";
    gateway_ = std::make_unique<Gateway>(options);
    gateway_->loop.add<msg::ServiceStatus>(
        gateway_->statuses, [this](const msg::ServiceStatus& status, const messaging::SampleInfo&) {
          const bool of_this_life =
              mapper_ && status.process_id() == static_cast<std::uint32_t>(mapper_->pid());
          if (of_this_life) mapper_status_ = status;
        });
    gateway_->loop.add(gateway_->scans);
    gateway_->loop.add_timer(kScanPeriod, [this] { gateway_->send_scan(); });
    gateway_->status.set_state(msg::kServiceRunning);
  }

  void start_mapper() {
    mapper_status_.reset();
    mapper_ = std::make_unique<Program>(
        scratch_, "local_mapper", std::vector<std::string>{"--domain", domain_, "--standalone"});
  }

  /// Sends the gateway's scans until `condition` holds.
  bool wait(const std::string& what, const std::function<bool()>& condition) {
    return wait_in_loop(gateway_->loop, what, condition);
  }
  [[nodiscard]] bool mapper_works() const { return mapper_status_ && mapper_status_->inputs() > 5; }

  void start_both() {
    start_gateway();
    start_mapper();
    ASSERT_TRUE(wait("the local mapper to get scans", [this] { return mapper_works(); }))
        << mapper_->err();
  }
  void expect_end() {
    ASSERT_TRUE(wait("the local mapper to end", [this] { return mapper_->ended(); }))
        << mapper_->err();
    EXPECT_EQ(mapper_->wait(), 1) << "what supervisors start again";
    EXPECT_THAT(mapper_->err(), HasSubstr("deaf: none of the "));
    EXPECT_THAT(mapper_->err(), HasSubstr(" scan that sensor_gateway has sent in "));
  }
  void expect_next_life() {
    start_mapper();
    EXPECT_TRUE(wait("the next local mapper to get scans", [this] { return mapper_works(); }))
        << mapper_->err();
  }

  struct Gateway {
    explicit Gateway(const messaging::ParticipantOptions& options)
        : participant(options), scans(participant), statuses(participant) {
      fill(scan);
    }
    void send_scan() {
      ++sent;
      messaging::set_header(scan, "robot", static_cast<std::int64_t>(sent) * 100'000'000, sent);
      static_cast<void>(scans.write(scan));
    }

    messaging::Participant participant;
    messaging::EventLoop loop;
    messaging::Writer<msg::Scan> scans;
    messaging::Reader<msg::ServiceStatus> statuses;
    messaging::StatusPublisher status{
        participant, loop, {"sensor_gateway", "", "robot", std::string(support::kVersion)}};
    msg::Scan scan;
    std::uint64_t sent = 0;
  };

  Scratch scratch_;
  std::string domain_ = own_domain();
  std::unique_ptr<Gateway> gateway_;
  std::unique_ptr<Program> mapper_;
  std::optional<msg::ServiceStatus> mapper_status_;
};

TEST_F(DeafnessTest, AServiceWhoseInputAloneIsLostIsAtWorkAgainInItsNextLife) {
  start_both();
  losses().lose_scans(true);
  expect_end();
  losses().lose_scans(false);
  expect_next_life();
}

// The status of the sender does not arrive either: only another participant receives it.
TEST_F(DeafnessTest, SoIsOneThatHearsNothingOfItsSender) {
  start_both();
  losses().lose_known_ports(true);
  expect_end();
  losses().lose_known_ports(false);
  expect_next_life();
}

TEST_F(DeafnessTest, SoIsOneThatHearsNothingOfItsSenderWithSecurity) {
  if (!make_keys()) GTEST_SKIP() << "openssl is missing";
  start_both();
  losses().lose_known_ports(true);
  expect_end();
  losses().lose_known_ports(false);
  expect_next_life();
}

}  // namespace
}  // namespace topogeo::test
