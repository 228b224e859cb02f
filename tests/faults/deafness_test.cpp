// A gateway that has forgotten a local mapper, after an interruption that the mapper has not
// noticed: the mapper gets no scans any more, nor anything else of it. It has to find that out, end
// with the exit code that its supervisors start it again for, and be at work in its next life.
//
// This test is the gateway. What comes to its sockets is lost while `deaf_gateway` is true.
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <dlfcn.h>
#include <gmock/gmock.h>
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

std::atomic<bool> deaf_gateway = false;

}  // namespace

// Takes the place of the function of the C library for the middleware, too.
extern "C" ssize_t recvfrom(int socket, void* buffer, std::size_t size, int flags,
                            sockaddr* address, socklen_t* address_size) {
  using Function = ssize_t (*)(int, void*, std::size_t, int, sockaddr*, socklen_t*);
  static const auto original = reinterpret_cast<Function>(::dlsym(RTLD_NEXT, "recvfrom"));
  while (true) {
    const ssize_t received = original(socket, buffer, size, flags, address, address_size);
    if (received < 0 || !deaf_gateway) return received;
  }
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
    deaf_gateway = false;
    ::unsetenv("TOPOGEO_SECURITY");  // NOLINT(concurrency-mt-unsafe): one thread
  }

  /// False where there is no openssl.
  bool make_keys() {
    const std::string make =
        "command -v openssl >/dev/null || exit 77; '" TOPOGEO_SOURCE_DIR
        "/deploy/security/make_keys' '" +
        (scratch_ / "keys").string() +
        "' issue --robot robot robot sensor_gateway local_mapper >/dev/null 2>&1";
    const int status = std::system(make.c_str());  // NOLINT(*-env33-c,concurrency-mt-unsafe)
    EXPECT_TRUE(status == 0 || WEXITSTATUS(status) == 77) << "make_keys";
    ::setenv("TOPOGEO_SECURITY", (scratch_ / "keys/robot").c_str(), 1);  // NOLINT: one thread
    return status == 0;
  }

  void start_gateway() {
    messaging::ParticipantOptions options;
    options.domain = static_cast<std::uint32_t>(std::stoul(domain_));
    options.name = "robot/sensor_gateway";
    options.identity = "sensor_gateway";
    gateway_ = std::make_unique<Gateway>(options);
    gateway_->loop.add<msg::ServiceStatus>(
        gateway_->statuses, [this](const msg::ServiceStatus& status, const messaging::SampleInfo&) {
          if (status.service() == "local_mapper") mapper_status_ = status;
        });
    gateway_->loop.add(gateway_->scans);
    gateway_->loop.add_timer(kScanPeriod, [this] { gateway_->send_scan(); });
    gateway_->status.set_state(msg::kServiceRunning);
  }

  void start_mapper() {
    mapper_status_.reset();
    mapper_ = std::make_unique<Program>(scratch_, "local_mapper",
                                        std::vector<std::string>{"--domain", domain_});
  }

  /// The gateway sends scans until `condition` holds.
  template <class Condition>
  bool wait(const std::string& what, const Condition& condition) {
    return wait_in_loop(gateway_->loop, what, condition);
  }
  [[nodiscard]] bool mapper_works() const { return mapper_status_ && mapper_status_->inputs() > 5; }

  /// The gateway forgets the mapper, whose lease is over, and hears it again.
  void forget_mapper() {
    deaf_gateway = true;
    EXPECT_TRUE(wait("the gateway to forget the mapper",
                     [this] { return gateway_->scans.matched() == 0; }));
    deaf_gateway = false;
  }

  void expect_return() {
    start_gateway();
    start_mapper();
    ASSERT_TRUE(wait("the local mapper to get scans", [this] { return mapper_works(); }))
        << mapper_->err();
    forget_mapper();
    ASSERT_TRUE(wait("the local mapper to end", [this] { return mapper_->ended(); }))
        << mapper_->err();
    EXPECT_EQ(mapper_->wait(), 1) << "what supervisors start again";
    EXPECT_THAT(mapper_->err(), HasSubstr("deaf: none of the "));
    EXPECT_THAT(mapper_->err(), HasSubstr("that sensor_gateway has sent in "));
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

TEST_F(DeafnessTest, AServiceThatItsSenderHasForgottenIsAtWorkAgainInItsNextLife) {
  expect_return();
}

TEST_F(DeafnessTest, SoIsOneWithSecurity) {
  if (!make_keys()) GTEST_SKIP() << "openssl is missing";
  expect_return();
}

}  // namespace
}  // namespace topogeo::test
