// The operator's stop while the service's loop is blocked, and among hostile connections.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>

#include "topogeo/msg/motion.h"
#include "topogeo/msg/sensor.h"

#include "messaging/fixture.hpp"
#include "waiting.hpp"
#include "web_client.hpp"
#include "web_service.hpp"

namespace topogeo::web {
namespace {

using test::http_post;
using test::WebSocketClient;

const std::string kStopToken = "0123456789abcdef";

service::Setup stop_setup(const std::string& partition) {
  service::Setup setup;
  setup.name = "web";
  setup.options.partition = partition;
  return setup;
}

ServerConfig stop_config() {
  ServerConfig config;
  config.token = kStopToken;
  return config;
}

/// The service with a base as its peer. Its loop runs only when a test lets it.
class WebStop : public testing::Test {
 protected:
  WebStop() {
    const bool heard = test::wait_for("a base that the service hears", [&] {
      return statuses_.matched() > 1 && commands_.matched() > 0 &&
             statuses_.write(messaging::message<msg::BaseStatus>()) && stop() == 202;
    });
    EXPECT_TRUE(heard);
    EXPECT_TRUE(test::wait_for("the first halt", [&] { return orders(msg::kBaseHalt) > 0; }));
  }
  [[nodiscard]] int stop() const { return http_post(web_.port(), "/api/stop", kStopToken).status; }
  /// Number of such orders received by the base.
  int orders(msg::BaseCommandKind kind) {
    commands_.take([&](const msg::BaseCommand& command, const messaging::SampleInfo& info) {
      if (info.valid) ++(command.kind() == msg::kBaseHalt ? halts_ : resets_);
    });
    return kind == msg::kBaseHalt ? halts_ : resets_;
  }

  std::string partition_ = messaging::random_partition();
  service::Service service_{stop_setup(partition_)};
  WebService web_{service_, stop_config(), PageFiles()};
  messaging::Participant base_{messaging::options_in(partition_)};
  messaging::Reader<msg::BaseCommand> commands_{base_};
  messaging::Writer<msg::BaseStatus> statuses_{base_};
  int halts_ = 0;
  int resets_ = 0;
};

TEST_F(WebStop, IsDoneWhileTheLoopOfTheServiceIsHeldUp) {
  const int before = orders(msg::kBaseHalt);
  EXPECT_EQ(stop(), 202);
  EXPECT_TRUE(test::wait_for("the halt", [&] { return orders(msg::kBaseHalt) > before; }));
}

TEST_F(WebStop, IsReleasedAfterTheGoalsOfBeforeAreCancelled) {
  auto released = std::async(std::launch::async, [this] {
    return http_post(web_.port(), "/api/release", kStopToken).status;
  });
  EXPECT_EQ(orders(msg::kBaseReset), 0) << "the loop, which cancels them, has not run";
  EXPECT_TRUE(test::wait_in_loop(service_.loop(), "the release", [&] {
    return released.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }));
  EXPECT_EQ(released.get(), 202);
  EXPECT_TRUE(test::wait_for("the reset", [&] { return orders(msg::kBaseReset) > 0; }));
}

/// Orders after which the robot may drive.
class WebStopDuringOrder : public WebStop, public testing::WithParamInterface<const char*> {
 protected:
  /// The result of `call`, made in another thread while the loop of the service runs.
  template <class Call>
  auto in_loop(const Call& call) {
    auto result = std::async(std::launch::async, call);
    EXPECT_TRUE(test::wait_in_loop(service_.loop(), "an answer", [&] {
      return result.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    }));
    return result.get();
  }
  /// The answer to an order that is sent now.
  std::string answer_now() {
    return in_loop([this] { return http_post(web_.port(), GetParam(), kStopToken, body_).body; });
  }
  /// The answer when the robot was stopped and released between header and body.
  std::string answer_after_stop() {
    const test::RawConnection order(web_.port());
    order.send(std::string("POST ") + GetParam() + " HTTP/1.1\r\nHost: 127.0.0.1\r\n" +
               "Authorization: Bearer " + kStopToken + "\r\nConnection: close\r\n" +
               "Content-Length: " + std::to_string(body_.size()) + "\r\n\r\n");
    // The connection thread reads the header before it accepts a later connection.
    EXPECT_EQ(test::http_get(web_.port(), "/api/info").status, 200);
    EXPECT_EQ(stop(), 202);
    EXPECT_EQ(in_loop([this] { return http_post(web_.port(), "/api/release", kStopToken).status; }),
              202);
    order.send(body_);
    return in_loop([&order] { return order.receive_all(); });
  }

  std::string body_ = GetParam() == std::string("/api/goal") ? R"({"x_m":1,"y_m":0})" : "{}";
};

TEST_P(WebStopDuringOrder, IsNotUndoneByIt) {
  EXPECT_THAT(answer_after_stop(), testing::HasSubstr("the robot was stopped meanwhile"));
  EXPECT_THAT(answer_now(), testing::Not(testing::HasSubstr("stopped meanwhile")));
}

INSTANTIATE_TEST_SUITE_P(Orders, WebStopDuringOrder,
                         testing::Values("/api/goal", "/api/explore", "/api/resume",
                                         "/api/return"));

/// A request body with many keys.
std::string many_keys(int keys) {
  std::string body = R"({"zones":[0])";
  for (int i = 1; i < keys; ++i) body += ",\"k" + std::to_string(i) + "\":0";
  return body + "}";
}

/// Sends requests without the token until `done`.
void attack(std::uint32_t port, const std::atomic<bool>& done) {
  const std::string body = many_keys(5000);
  while (!done) {
    try {
      static_cast<void>(http_post(port, "/api/room_shapes", "", body));
      WebSocketClient spectator(port);
      for (int i = 0; i < 10; ++i) spectator.send_text(many_keys(290));
    } catch (const std::runtime_error&) {
      continue;  // refused, or displaced by another connection
    }
  }
}

TEST_F(WebStop, IsTakenAmongHostileConnections) {
  constexpr int kIdle = 256;
  constexpr int kSpectators = 64;
  constexpr int kAttackers = 16;
  std::vector<std::unique_ptr<test::RawConnection>> idle;
  for (int i = 0; i < kIdle; ++i) {
    idle.push_back(std::make_unique<test::RawConnection>(web_.port()));
    idle.back()->send("GET / HTTP/1.1\r\nHost");  // the rest of the request never comes
  }
  std::vector<std::unique_ptr<WebSocketClient>> spectators;
  spectators.reserve(kSpectators);
  for (int i = 0; i < kSpectators; ++i) {
    spectators.push_back(std::make_unique<WebSocketClient>(web_.port()));
  }
  std::atomic<bool> done = false;
  std::atomic<bool> ended = false;
  std::thread loop([&] {
    while (!ended) service_.loop().run_for(std::chrono::milliseconds(5));
  });
  std::vector<std::thread> attackers;
  attackers.reserve(kAttackers);
  for (int i = 0; i < kAttackers; ++i) {
    attackers.emplace_back([&] { attack(web_.port(), done); });
  }
  std::chrono::steady_clock::duration slowest{};
  int taken = 0;
  for (int i = 0; i < 40; ++i) {
    const auto begun = std::chrono::steady_clock::now();
    if (stop() == 202) ++taken;
    slowest = std::max(slowest, std::chrono::steady_clock::now() - begun);
  }
  EXPECT_NO_THROW(WebSocketClient(web_.port(), test::token_header(kStopToken)));
  done = true;
  for (std::thread& attacker : attackers) attacker.join();
  ended = true;
  loop.join();
  EXPECT_EQ(taken, 40);
  std::printf("the slowest of 40 stops took %.0f ms\n",
              std::chrono::duration<double, std::milli>(slowest).count());
}

}  // namespace
}  // namespace topogeo::web
