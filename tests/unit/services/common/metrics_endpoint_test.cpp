// Metrics of a service over HTTP.
#include "topogeo/service/metrics_endpoint.hpp"

#include <stdexcept>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <sys/socket.h>

#include "topogeo/messaging/message.hpp"
#include "topogeo/support/file_descriptor.hpp"

namespace topogeo::service {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// The answer to a request, head and body; empty when the port is closed.
std::string ask(std::uint32_t port, const std::string& request) {
  const support::FileDescriptor line(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in peer{};
  peer.sin_family = AF_INET;
  peer.sin_port = htons(static_cast<std::uint16_t>(port));
  peer.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(line.get(), reinterpret_cast<const sockaddr*>(&peer), sizeof peer) != 0) return {};
  if (::send(line.get(), request.data(), request.size(), MSG_NOSIGNAL) < 0) return {};
  std::string answer;
  std::array<char, 4096> piece{};
  for (ssize_t n = 0; (n = ::recv(line.get(), piece.data(), piece.size(), 0)) > 0;) {
    answer.append(piece.data(), static_cast<std::size_t>(n));
  }
  return answer;
}

std::string get(std::uint32_t port, const std::string& path) {
  return ask(port, "GET " + path + " HTTP/1.0\r\n\r\n");
}

msg::ServiceStatus planner_status(double goals) {
  msg::ServiceStatus status;
  messaging::set_header(status, "r1", 0, 0);
  messaging::set_service(status, "planner", "pc-1");
  msg::Counter counter;
  messaging::set_text(counter.name(), "goals", "counter");
  counter.value(goals);
  status.counters().push_back(counter);
  return status;
}

TEST(MetricsEndpoint, GivesTheLastStatus) {
  MetricsEndpoint endpoint({"127.0.0.1", 0, 1});
  ASSERT_GT(endpoint.port(), 0U);
  EXPECT_THAT(get(endpoint.port(), "/metrics"), AllOf(HasSubstr("200"), Not(HasSubstr("goals"))));
  endpoint.update(planner_status(1.0));
  endpoint.update(planner_status(3.0));
  const std::string text = get(endpoint.port(), "/metrics");
  EXPECT_THAT(text, HasSubstr("# TYPE topogeo_goals_total counter"));
  EXPECT_THAT(text, HasSubstr("# HELP topogeo_goals_total goals taken"));
  EXPECT_THAT(text, HasSubstr("topogeo_goals_total{service=\"planner\",robot=\"r1\",host=\"\"} 3"));
  EXPECT_THAT(get(endpoint.port(), "/secrets"), HasSubstr("404"));
}

TEST(MetricsEndpoint, WrongRequestsAreAnsweredOrCutOff) {
  MetricsEndpoint endpoint({"127.0.0.1", 0, 1});
  endpoint.update(planner_status(1.0));
  EXPECT_THAT(ask(endpoint.port(), "POST /metrics HTTP/1.1\r\nHost: x\r\n\r\n"), HasSubstr("405"));
  EXPECT_EQ(ask(endpoint.port(), "nothing that is HTTP\r\n\r\n"), "");
  EXPECT_EQ(ask(endpoint.port(), "GET /" + std::string(100'000, 'x') + " HTTP/1.1\r\n\r\n"), "");
  EXPECT_THAT(get(endpoint.port(), "/metrics"), HasSubstr("goals")) << "it goes on";
}

TEST(MetricsEndpoint, PeersThatSayNothingDoNotKeepOthersWaiting) {
  MetricsEndpoint endpoint({"127.0.0.1", 0, 1});
  endpoint.update(planner_status(1.0));
  std::vector<support::FileDescriptor> silent;
  sockaddr_in peer{};
  peer.sin_family = AF_INET;
  peer.sin_port = htons(static_cast<std::uint16_t>(endpoint.port()));
  peer.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  for (int i = 0; i < 8; ++i) {
    silent.emplace_back(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    ASSERT_EQ(::connect(silent.back().get(), reinterpret_cast<const sockaddr*>(&peer), sizeof peer),
              0);
  }
  EXPECT_THAT(get(endpoint.port(), "/metrics"), HasSubstr("goals"));
}

TEST(MetricsEndpoint, PortInUseIsRefusedUnlessThereAreMore) {
  const MetricsEndpoint first({"127.0.0.1", 0, 1});
  try {
    const MetricsEndpoint second({"127.0.0.1", first.port(), 1});
    FAIL() << "two listen on one port";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("127.0.0.1, port " + std::to_string(first.port())));
  }
  const MetricsEndpoint next({"127.0.0.1", first.port(), 20});
  EXPECT_GT(next.port(), first.port());
}

TEST(MetricsEndpoint, GoesAwayWithItsPort) {
  std::uint32_t port = 0;
  {
    const MetricsEndpoint endpoint({"127.0.0.1", 0, 1});
    port = endpoint.port();
  }
  EXPECT_EQ(get(port, "/metrics"), "");
}

TEST(MetricsEndpoint, EachServiceHasAPlaceBehindTheConfiguredPort) {
  EXPECT_EQ(metrics_address("127.0.0.1", 9464, "sensor_gateway").port, 9464U);
  EXPECT_EQ(metrics_address("127.0.0.1", 9464, "navigator").port, 9469U);
  EXPECT_EQ(metrics_address("127.0.0.1", 9464, "ga_worker").port, 9471U);
  EXPECT_GT(metrics_address("127.0.0.1", 9464, "ga_worker").ports, 1U);
  EXPECT_EQ(metrics_address("10.0.0.1", 9464, "planner").address, "10.0.0.1");
}

}  // namespace
}  // namespace topogeo::service
