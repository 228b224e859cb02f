#include "sensor_gateway/stop_sentry.hpp"

#include <array>
#include <csignal>
#include <optional>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace topogeo::sensor_gateway {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kNever{1'000'000'000};
const std::vector<std::uint8_t> kStop{145, 0, 0, 0, 0};

/// A port whose far end the test reads.
class Port {
 public:
  Port() { EXPECT_EQ(::pipe(ends_.data()), 0); }
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  Port(Port&&) = delete;
  Port& operator=(Port&&) = delete;
  ~Port() {
    ::close(ends_[0]);
    if (ends_[1] >= 0) ::close(ends_[1]);
  }
  [[nodiscard]] int near_end() const { return ends_[1]; }
  void close_near_end() {
    ::close(ends_[1]);
    ends_[1] = -1;
  }
  /// Waits for as many bytes as the order to stop has; fewer at the end of the port.
  std::vector<std::uint8_t> read() {
    std::vector<std::uint8_t> bytes(kStop.size());
    std::size_t got = 0;
    while (got < bytes.size()) {
      const ssize_t count = ::read(ends_[0], bytes.data() + got, bytes.size() - got);
      if (count <= 0) break;
      got += static_cast<std::size_t>(count);
    }
    bytes.resize(got);
    return bytes;
  }

 private:
  std::array<int, 2> ends_{-1, -1};
};

TEST(StopSentry, StopsTheBaseOfAKilledGateway) {
  Port port;
  const pid_t gateway = ::fork();
  if (gateway == 0) {
    StopSentry sentry(port.near_end(), kStop, kNever);
    sentry.alive();
    ::raise(SIGKILL);
  }
  port.close_near_end();
  EXPECT_EQ(port.read(), kStop);
  EXPECT_TRUE(port.read().empty()) << "then it ends";
  int status = 0;
  ASSERT_EQ(::waitpid(gateway, &status, 0), gateway);
  EXPECT_TRUE(WIFSIGNALED(status));
}

TEST(StopSentry, StopsTheBaseOfAFrozenGatewayEachTime) {
  Port port;
  StopSentry sentry(port.near_end(), kStop, milliseconds(1));
  for (int time = 0; time < 3; ++time) {
    sentry.alive();
    EXPECT_EQ(port.read(), kStop);
  }
}

TEST(StopSentry, StopsTheBaseWhenItEnds) {
  Port port;
  { const StopSentry sentry(port.near_end(), kStop, kNever); }
  EXPECT_EQ(port.read(), kStop);
}

TEST(StopSentry, OutlivesAPortThatTakesNothing) {
  std::optional<StopSentry> sentry;
  {
    Port port;
    sentry.emplace(port.near_end(), kStop, milliseconds(1));
  }  // nobody reads any more
  sentry->alive();
  sentry.reset();
}

}  // namespace
}  // namespace topogeo::sensor_gateway
