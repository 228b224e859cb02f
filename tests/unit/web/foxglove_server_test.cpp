// The server with a client that uses Foxglove's protocol.
#include <chrono>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "foxglove/foxglove_feed.hpp"
#include "server/server.hpp"
#include "waiting.hpp"
#include "web_client.hpp"

namespace topogeo::web {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using test::WebSocketClient;
using testing::HasSubstr;
using testing::Not;

const milliseconds kFoxglovePatience = test::hang_limit();

class NoBackend : public Backend {
 public:
  [[nodiscard]] const Route* route(Method, std::string_view) const override { return nullptr; }
  void handle(const Request&, Respond respond) override { respond(error_answer(404, "none")); }
  void stop(const std::string&, Respond respond) override { respond(error_answer(404, "none")); }
  void release_stop(const std::string&, Respond respond) override {
    respond(error_answer(404, "none"));
  }
  [[nodiscard]] std::uint64_t stops() const override { return 0; }
  void drive(std::uint64_t, double, double) override {}
  void release(std::uint64_t) override {}
};

struct FoxgloveMessage {
  std::uint32_t subscription = 0;
  json content;
};

class FoxgloveServer : public testing::Test {
 protected:
  FoxgloveServer() {
    config_.robot_id = "robot";
    config_.life = "life1";
    server_ = std::make_unique<Server>(config_, hub_, files_, backend_, tally_, feed_);
  }
  [[nodiscard]] std::unique_ptr<WebSocketClient> connect(
      const std::string& offered = "foxglove.websocket.v1") const {
    return std::make_unique<WebSocketClient>(server_->port(),
                                             test::Headers{{"Sec-WebSocket-Protocol", offered}});
  }
  /// The next text message with an operation.
  static json next_text(WebSocketClient& client) {
    while (const auto text = client.receive(kFoxglovePatience)) {
      if (text->starts_with('{')) return json::parse(*text);
    }
    return {};
  }
  static json next_status(WebSocketClient& client) {
    json text = next_text(client);
    while (text.is_object() && text["op"] != "status") text = next_text(client);
    return text;
  }
  static std::optional<FoxgloveMessage> next_message(WebSocketClient& client,
                                                     milliseconds patience = kFoxglovePatience) {
    while (const auto bytes = client.receive(patience)) {
      if (bytes->starts_with('{')) continue;
      FoxgloveMessage message;
      std::memcpy(&message.subscription, bytes->data() + 1, sizeof(message.subscription));
      message.content = json::parse(bytes->substr(13));
      return message;
    }
    return std::nullopt;
  }
  static void subscribe(WebSocketClient& client, std::uint32_t id, std::uint32_t channel) {
    client.send({{"op", "subscribe"},
                 {"subscriptions", json::array({{{"id", id}, {"channelId", channel}}})}});
  }

  ServerConfig config_;
  ChannelHub hub_;
  PageFiles files_;
  NoBackend backend_;
  Tally tally_;
  FoxgloveFeed feed_;
  std::unique_ptr<Server> server_;
};

TEST_F(FoxgloveServer, GreetsWithItsTopics) {
  const auto client = connect("foxglove.websocket.v1, foxglove.sdk.v1");
  EXPECT_THAT(client->handshake(), HasSubstr("Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n"));
  const json info = next_text(*client);
  EXPECT_EQ(info["op"], "serverInfo");
  EXPECT_EQ(info["sessionId"], "life1");
  EXPECT_EQ(info["capabilities"], json::array());
  EXPECT_EQ(next_text(*client)["op"], "advertise");
  EXPECT_THAT(connect()->handshake(), HasSubstr("Protocol: foxglove.websocket.v1\r\n"));
  EXPECT_THAT(connect("foxglove.websocket.v9")->handshake(), Not(HasSubstr("Protocol:")))
      << "a page";
}

TEST_F(FoxgloveServer, ALateSubscriberGetsTheNewest) {
  feed_.set(LiveTopic::kMap, [] { return std::string(R"({"map":1})"); });
  hub_.edit(Channel::kRooms, {{"0", R"({"name":"hall","x_m":1,"y_m":2})"}});
  const auto client = connect();
  subscribe(*client, 17, 4);
  auto message = next_message(*client);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->subscription, 17U);
  EXPECT_EQ(message->content["map"], 1);
  subscribe(*client, 3, 7);
  message = next_message(*client);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->subscription, 3U);
  EXPECT_EQ(message->content["entities"][0]["texts"][0]["text"], "hall");
  // Later changes arrive, too, but none of a topic after its last unsubscription.
  client->send({{"op", "unsubscribe"}, {"subscriptionIds", {17}}});
  client->send(
      {{"op", "subscribe"}, {"subscriptions", json::array({{{"id", 4}, {"channelId", 2}}})}});
  client->send({{"op", "garbage"}});
  EXPECT_EQ(next_status(*client)["level"], 2) << "all before it is done";
  feed_.set(LiveTopic::kMap, [] { return std::string(R"({"map":2})"); });
  feed_.set(LiveTopic::kPose, [] { return std::string(R"({"pose":1})"); });
  message = next_message(*client);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->subscription, 4U);
}

TEST_F(FoxgloveServer, WhatItDoesNotOfferIsAnsweredByAStatus) {
  const auto client = connect();
  for (const char* text :
       {R"({"op":"advertise","channels":[]})", R"({"op":7})", "garbage", "[]",
        R"({"op":"subscribe"})", R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[7]})",
        R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]})",
        R"({"op":"unsubscribe","subscriptionIds":["x"]})"}) {
    client->send_text(text);
    const json answer = next_status(*client);
    EXPECT_EQ(answer["level"], 2) << text;
    EXPECT_FALSE(answer["message"].get<std::string>().empty());
  }
  // One subscription for each channel, and each with a unique id.
  for (const auto& [id, channel] : {std::pair{1, 1}, {1, 2}, {2, 1}}) {
    subscribe(*client, static_cast<std::uint32_t>(id), static_cast<std::uint32_t>(channel));
  }
  EXPECT_EQ(next_status(*client)["level"], 1);
  EXPECT_EQ(next_status(*client)["level"], 1);
  client->send({{"op", "unsubscribe"}, {"subscriptionIds", {8}}});
  EXPECT_EQ(next_status(*client)["level"], 1);
}

TEST_F(FoxgloveServer, ASlowClientGetsTheNewestAndNoQueue) {
  const auto client = connect();
  subscribe(*client, 1, 3);
  constexpr int kChanges = 2000;
  const std::string filler(20'000, 'x');  // 40 MB in all, more than buffers hold
  for (int i = 1; i <= kChanges; ++i) {
    feed_.set(LiveTopic::kScan, [&filler, i] {
      return json{{"number", i}, {"filler", filler}}.dump();
    });
  }
  int received = 0;
  int last = 0;
  while (last < kChanges) {
    const auto message = next_message(*client);
    ASSERT_TRUE(message) << "after " << received;
    EXPECT_GT(message->content["number"], last);
    last = message->content["number"];
    ++received;
  }
  EXPECT_LE(received, kChanges);
}

TEST_F(FoxgloveServer, PagesOfOtherSitesAreRefused) {
  const auto with_origin = [&](const char* origin) {
    return WebSocketClient(server_->port(),
                           {{"Sec-WebSocket-Protocol", "foxglove.sdk.v1"}, {"Origin", origin}})
        .handshake();
  };
  EXPECT_THROW(with_origin("https://evil.example"), std::runtime_error);
  server_.reset();
  config_.origins = {"file://"};
  server_ = std::make_unique<Server>(config_, hub_, files_, backend_, tally_, feed_);
  EXPECT_THAT(with_origin("file://"), HasSubstr(" 101 "));
}

}  // namespace
}  // namespace topogeo::web
