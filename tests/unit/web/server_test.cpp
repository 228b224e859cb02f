// The server alone, with the test's own hub and backend.
#include "server/server.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>

#include "routes.hpp"
#include "waiting.hpp"
#include "web_client.hpp"

namespace topogeo::web {
namespace {

using std::chrono::milliseconds;
using test::Headers;
using test::http_get;
using test::http_post;
using test::http_request;
using test::HttpReply;
using test::PageModel;
using test::WebSocketClient;
using testing::HasSubstr;
using testing::Not;

const milliseconds kPatience = test::hang_limit();
const std::string kToken = "0123456789abcdef";

/// Has the routes of the service. Echoes its requests, and counts driving commands.
class EchoBackend : public Backend {
 public:
  ~EchoBackend() override { free(); }
  [[nodiscard]] const Route* route(Method method, std::string_view path) const override {
    const ServiceRoute* found = find_route(method, path);
    return found != nullptr ? &found->route : nullptr;
  }
  void handle(const Request& request, Respond respond) override {
    const std::scoped_lock lock(busy_);
    Answer answer;
    answer.body = (request.post ? "POST " : "GET ") + request.path + "?" + request.query + " " +
                  request.body + (request.authorized ? " authorized" : "");
    respond(answer);
  }
  void stop(const std::string&, Respond respond) override {
    ++stopped;
    respond({202, "{}"});
  }
  void release_stop(const std::string&, Respond respond) override { respond({202, "{}"}); }
  [[nodiscard]] std::uint64_t stops() const override {
    return static_cast<std::uint64_t>(stopped.load());
  }
  void drive(std::uint64_t viewer, double linear_mps, double) override {
    driver = viewer;
    speed_mps = linear_mps;
    ++drives;
  }
  void release(std::uint64_t viewer) override {
    if (viewer == driver) ++releases;
  }
  std::atomic<std::uint64_t> driver = 0;
  std::atomic<double> speed_mps = 0.0;
  std::atomic<int> drives = 0;
  std::atomic<int> releases = 0;
  std::atomic<int> stopped = 0;

  /// Blocks all requests until free().
  void hold() { held_ = std::unique_lock(busy_); }
  void free() {
    if (held_.owns_lock()) held_.unlock();
  }

 private:
  std::mutex busy_;
  std::unique_lock<std::mutex> held_;
};

class WebServer : public testing::Test {
 protected:
  WebServer() {
    config_.token = kToken;
    config_.life = "life1";
    config_.robot_id = "robot";
    config_.hosts = {"desk"};
    config_.clock_s = [] { return 1.0; };  // stopped: rate limits do not refill
    start();
  }
  void start() {
    server_ = std::make_unique<Server>(config_, hub_, files_, backend_, tally_, feed_);
  }
  [[nodiscard]] std::uint32_t port() const { return server_->port(); }
  [[nodiscard]] std::uint64_t refused(const std::string& reason) const {
    const auto counts = tally_.counts();
    const auto found = counts.find("refused: " + reason);
    return found == counts.end() ? 0 : found->second;
  }

  ServerConfig config_;
  ChannelHub hub_;
  PageFiles files_;
  EchoBackend backend_;
  Tally tally_;
  FoxgloveFeed feed_;
  std::unique_ptr<Server> server_;
};

TEST_F(WebServer, GivesThePageAndWhatTheBackendHas) {
  const HttpReply page = http_get(port(), "/");
  EXPECT_EQ(page.status, 200);
  EXPECT_THAT(page.head, HasSubstr("text/html"));
  EXPECT_THAT(page.head, HasSubstr("Content-Security-Policy"));
  EXPECT_EQ(http_get(port(), "/api/x?a=1").body, "GET /api/x?a=1 ");
}

TEST_F(WebServer, AKnownFileIsNotSentAgain) {
  const std::string head = http_get(port(), "/").head;
  const std::size_t begin = head.find("ETag: ") + 6;
  const std::string tag = head.substr(begin, head.find("\r\n", begin) - begin);
  const HttpReply again = http_request(port(), "GET", "/", {{"If-None-Match", tag}});
  EXPECT_EQ(again.status, 304);
  EXPECT_EQ(again.body, "");
}

TEST_F(WebServer, WritingNeedsTheToken) {
  EXPECT_EQ(http_post(port(), "/api/goal", "", "{}").status, 401);
  EXPECT_EQ(http_post(port(), "/api/goal", "0123456789abcdeX", "garbage").status, 401);
  EXPECT_EQ(http_post(port(), "/api/anything", "").status, 401);
  EXPECT_EQ(refused("no token"), 3U);
  const HttpReply good = http_post(port(), "/api/goal", kToken, "{1}");
  EXPECT_EQ(good.status, 200);
  EXPECT_EQ(good.body, "POST /api/goal? {1} authorized");
}

TEST_F(WebServer, ForeignPagesAndNamesAreRefused) {
  const std::string bearer = "Bearer " + kToken;
  const auto post = [&](const Headers& headers) {
    return http_request(port(), "POST", "/api/goal", headers, "{}").status;
  };
  EXPECT_EQ(post({{"Authorization", bearer}, {"Origin", "http://evil.example"}}), 403);
  EXPECT_EQ(post({{"Authorization", bearer}, {"Host", "evil.example"}}), 403);
  const std::string own = "http://127.0.0.1:" + std::to_string(port());
  EXPECT_EQ(post({{"Authorization", bearer}, {"Origin", own}}), 200);
  EXPECT_THROW(WebSocketClient(port(), {{"Origin", "http://evil.example"}}), std::runtime_error);
  EXPECT_EQ(refused("foreign origin"), 2U);
  EXPECT_EQ(refused("foreign host"), 1U);
  EXPECT_EQ(http_request(port(), "GET", "/", {{"Host", "desk:1"}}).status, 200);
}

// The proxy sends its own name as Host, the browser sends the site's as Origin.
TEST_F(WebServer, PagesOfAProxyThatIsNamedMayUseIt) {
  const Headers headers = {{"Authorization", "Bearer " + kToken},
                           {"Host", "127.0.0.1:9"},
                           {"Origin", "https://robot.example"}};
  EXPECT_EQ(http_request(port(), "POST", "/api/goal", headers, "{}").status, 403);
  config_.origins = {"https://robot.example"};
  server_.reset();
  start();
  EXPECT_EQ(http_request(port(), "POST", "/api/goal", headers, "{}").status, 200);
  EXPECT_NO_THROW(WebSocketClient(port(), {{"Origin", "https://robot.example"}}));
  EXPECT_THROW(WebSocketClient(port(), {{"Origin", "http://robot.example"}}), std::runtime_error);
}

TEST_F(WebServer, DrawingsAndMapFilesMayBeLargeForWhoHasTheToken) {
  const std::string drawing(5'000'000, 'x');
  EXPECT_EQ(http_post(port(), "/api/drawing", kToken, drawing).status, 200);
  EXPECT_EQ(http_post(port(), "/api/floor", kToken, drawing).status, 200);
  EXPECT_EQ(http_post(port(), "/api/drawing", "", std::string(100'000, 'x')).status, 401);
  EXPECT_EQ(http_post(port(), "/api/goal", kToken, std::string(70'000, 'x')).status, 413);
  EXPECT_EQ(http_post(port(), "/api/drawing", kToken, drawing + drawing).status, 413);
  const std::string map = drawing + drawing + drawing;
  EXPECT_GT(http_post(port(), "/api/merge_map?x=1", kToken, map).body.size(), map.size());
  EXPECT_EQ(refused("no token"), 1U);
  EXPECT_EQ(refused("too large"), 2U);
}

TEST_F(WebServer, StopIsAnsweredWhileNothingElseIs) {
  backend_.hold();
  auto slow = std::async(std::launch::async, [&] { return http_get(port(), "/api/x").status; });
  auto goal =
      std::async(std::launch::async, [&] { return http_post(port(), "/api/goal", kToken).status; });
  for (int i = 0; i < 40; ++i) {
    ASSERT_EQ(http_post(port(), "/api/stop", kToken).status, 202);
    ASSERT_EQ(http_post(port(), "/api/release", kToken).status, 202);
  }
  EXPECT_EQ(backend_.stopped, 40);
  EXPECT_EQ(slow.wait_for(milliseconds(0)), std::future_status::timeout);
  backend_.free();
  EXPECT_EQ(slow.get(), 200);
  EXPECT_EQ(goal.get(), 200);
}

TEST_F(WebServer, AStopByTheWebSocketNeedsTheToken) {
  const auto answered = [&](WebSocketClient& socket, const char* op) {
    PageModel page;
    return page.wait_for(
        socket,
        [&] { return std::ranges::any_of(page.others, [&](auto& m) { return m["op"] == op; }); },
        kPatience);
  };
  WebSocketClient watcher(port());
  watcher.send({{"op", "stop"}});
  EXPECT_TRUE(answered(watcher, "refused"));
  EXPECT_EQ(backend_.stopped, 0);
  backend_.hold();
  WebSocketClient page(port(), test::token_header(kToken));
  page.send({{"op", "stop"}});
  EXPECT_TRUE(answered(page, "stopped"));
  EXPECT_EQ(backend_.stopped, 1);
  backend_.free();
}

// The clock is stopped: the strangers' quota does not refill.
TEST_F(WebServer, StrangersUseUpNothingOfTheOperators) {
  const std::string request = "GET /api/x HTTP/1.1\r\nHost: 127.0.0.1\r\n";
  std::string requests;
  for (int i = 0; i < 1500; ++i) requests += request + "\r\n";
  std::ignore =
      test::exchange_bytes(port(), requests + request + "Connection: close\r\n\r\n", kPatience);
  ASSERT_EQ(http_get(port(), "/api/x").status, 429);
  EXPECT_THROW(WebSocketClient{port()}, std::runtime_error);
  EXPECT_NO_THROW(WebSocketClient(port(), test::token_header(kToken)));
  for (int i = 0; i < 40; ++i) ASSERT_EQ(http_post(port(), "/api/stop", kToken).status, 202);
  EXPECT_EQ(http_post(port(), "/api/goal", kToken).status, 200);
  for (int i = 0; i < 20; ++i) {
    if (http_post(port(), "/api/room_shapes", "").status == 429) break;
  }
  EXPECT_EQ(http_post(port(), "/api/room_shapes", "").status, 429);
  EXPECT_EQ(http_post(port(), "/api/room_shapes", kToken).status, 200);
}

TEST_F(WebServer, SpectatorsLeaveRoomForTheOperator) {
  std::vector<std::unique_ptr<WebSocketClient>> spectators;
  for (std::uint32_t i = 0; i < config_.most_viewers; ++i) {
    spectators.push_back(std::make_unique<WebSocketClient>(port()));
  }
  EXPECT_THROW(WebSocketClient{port()}, std::runtime_error);
  EXPECT_THROW(WebSocketClient(port(), test::token_header("another token")), std::runtime_error);
  WebSocketClient page(port(), test::token_header(kToken));
  EXPECT_THAT(page.handshake(), HasSubstr("Sec-WebSocket-Protocol: topogeo"));
  page.send({{"op", "hello"}});
  PageModel model;
  ASSERT_TRUE(model.wait_for(
      page, [&] { return !model.others.empty(); }, kPatience));
  EXPECT_EQ(model.others.at(0)["may_write"], true);
  EXPECT_NO_THROW(WebSocketClient(port(), {{"Authorization", "Bearer " + kToken}}));
}

TEST_F(WebServer, WithoutAPlaceTheStrangerThatIsSilentLongestLeaves) {
  test::RawConnection with_token(port());
  with_token.send("GET /api/x HTTP/1.1\r\nHost: 127.0.0.1\r\nAuthorization: Bearer " + kToken +
                  "\r\n\r\n");
  EXPECT_THAT(with_token.receive_head(), HasSubstr(" 200 OK"));
  std::vector<std::unique_ptr<test::RawConnection>> idle;
  idle.reserve(300);
  for (int i = 0; i < 300; ++i) idle.push_back(std::make_unique<test::RawConnection>(port()));
  EXPECT_TRUE(idle.front()->ends());
  EXPECT_EQ(http_get(port(), "/api/x").status, 200);
  EXPECT_EQ(http_post(port(), "/api/stop", kToken).status, 202);
  with_token.send("GET /api/x HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
  EXPECT_THAT(with_token.receive_head(), HasSubstr(" 200 OK"));
}

TEST_F(WebServer, BodiesComeOnlyWhereAnOrderTakesOne) {
  const std::string chunked =
      "GET /api/merge_map HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\n\r\n"
      "2\r\nab\r\n0\r\n\r\n";
  EXPECT_THAT(test::exchange_bytes(port(), chunked, kPatience), HasSubstr(" 413 "));
  const std::string counted =
      "GET /api/merge_map HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 2\r\n\r\nab";
  EXPECT_THAT(test::exchange_bytes(port(), counted, kPatience), HasSubstr(" 413 "));
  // An order without the token is refused before its body arrives.
  test::RawConnection waits(port());
  waits.send("POST /api/goal HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 60000\r\n\r\n");
  EXPECT_THAT(waits.receive_head(), HasSubstr(" 401 "));
  EXPECT_EQ(http_post(port(), "/api/room_shapes", "", std::string(70'000, 'x')).status, 413);
}

TEST_F(WebServer, WhatIsTooMuchOrNoHttpIsRefused) {
  EXPECT_EQ(http_post(port(), "/api/goal", kToken, std::string(100'000, 'x')).status, 413);
  EXPECT_EQ(http_request(port(), "GET", "/", {{"X", std::string(20'000, 'x')}}).status, 413);
  EXPECT_EQ(refused("too large"), 2U);
  EXPECT_THAT(test::exchange_bytes(port(), std::string("\x16\x03\x01 no HTTP\r\n\r\n"), kPatience),
              HasSubstr("400"));
  EXPECT_EQ(refused("no HTTP"), 1U);
  EXPECT_EQ(http_request(port(), "DELETE", "/").status, 405);
  // Many on one connection, while the clock is stopped.
  const std::string order = "POST /x HTTP/1.1\r\nHost: 127.0.0.1\r\nAuthorization: Bearer " +
                            kToken + "\r\nContent-Length: 0\r\n";
  std::string orders;
  for (int i = 0; i < 199; ++i) orders += order + "\r\n";
  const std::string answers =
      test::exchange_bytes(port(), orders + order + "Connection: close\r\n\r\n", kPatience);
  EXPECT_THAT(answers, HasSubstr(" 200 OK"));
  EXPECT_THAT(answers, HasSubstr(" 429 "));
  EXPECT_GT(refused("too often"), 0U);
}

TEST_F(WebServer, ALateViewerGetsAllAndThenWhatChanges) {
  hub_.set(Channel::kPose, R"({"x_m":1})");
  hub_.edit(Channel::kGraph, {{"n1", "1"}, {"n2", "2"}});
  WebSocketClient socket(port());
  PageModel page;
  ASSERT_TRUE(page.wait_for(
      socket, [&] { return page.has("graph") && page.has("pose"); }, kPatience));
  EXPECT_EQ(page.others.at(0)["op"], "welcome");
  EXPECT_EQ(page.others.at(0)["may_write"], false);
  EXPECT_EQ(page.values["pose"]["x_m"], 1);
  hub_.edit(Channel::kGraph, {{"n1", ""}, {"n3", "3"}});
  ASSERT_TRUE(page.wait_for(
      socket, [&] { return page.versions["graph"] == 2; }, kPatience));
  EXPECT_THAT(page.tables["graph"],
              testing::ElementsAre(testing::Pair("n2", 2), testing::Pair("n3", 3)));
}

TEST_F(WebServer, WhoComesBackGetsTheRest) {
  hub_.edit(Channel::kGraph, {{"n1", "1"}});
  PageModel page;
  {
    WebSocketClient socket(port());
    ASSERT_TRUE(page.wait_for(
        socket, [&] { return page.has("graph"); }, kPatience));
  }
  hub_.edit(Channel::kGraph, {{"n1", ""}, {"n2", "2"}});
  const int snapshots = page.snapshots;
  WebSocketClient socket(port());
  socket.send({{"op", "hello"}, {"life", "life1"}, {"have", page.versions}});
  ASSERT_TRUE(page.wait_for(
      socket, [&] { return page.versions["graph"] == 2; }, kPatience));
  EXPECT_EQ(page.snapshots, snapshots) << "a delta";
  EXPECT_EQ(page.tables["graph"].size(), 1U);
}

TEST_F(WebServer, AServiceThatStartedAgainBeginsAnew) {
  hub_.edit(Channel::kGraph, {{"n1", "1"}});
  WebSocketClient socket(port());
  socket.send({{"op", "hello"}, {"life", "another"}, {"have", {{"graph", 1}}}});
  PageModel page;
  ASSERT_TRUE(page.wait_for(
      socket, [&] { return page.has("graph"); }, kPatience));
  EXPECT_EQ(page.tables["graph"].size(), 1U);
  socket.send({{"op", "resync"}, {"channel", "graph"}});
  const int snapshots = page.snapshots;
  ASSERT_TRUE(page.wait_for(
      socket, [&] { return page.snapshots > snapshots; }, kPatience));
}

TEST_F(WebServer, AViewerGetsTheChannelsItWants) {
  hub_.set(Channel::kPose, "1");
  hub_.set(Channel::kScan, "1");
  WebSocketClient socket(port());
  socket.send({{"op", "hello"}, {"channels", {"pose"}}});
  socket.send({{"op", "ping"}});
  PageModel page;
  ASSERT_TRUE(page.wait_for(
      socket, [&] { return page.has("pose") && page.others.size() >= 2; }, kPatience));
  EXPECT_FALSE(page.has("scan"));
  socket.send({{"op", "channels"}, {"channels", {"scan"}}});
  ASSERT_TRUE(page.wait_for(
      socket, [&] { return page.has("scan"); }, kPatience));
}

TEST_F(WebServer, ASlowViewerHoldsNobodyUpAndEndsExact) {
  WebSocketClient slow(port());
  WebSocketClient fast(port());
  PageModel fast_page;
  const std::string filler(20'000, 'x');
  constexpr int kChanges = 2000;  // 40 MB, more than buffers hold
  // Viewers read nothing meanwhile: a hub that waited for them would never finish.
  for (int i = 1; i <= kChanges; ++i) {
    hub_.set(Channel::kScan, "\"" + filler + std::to_string(i) + "\"");
    hub_.edit(Channel::kGraph, {{"n" + std::to_string(i % 50), std::to_string(i)}});
  }
  const auto done = [&](PageModel& page) {
    return page.versions["scan"] == kChanges && page.versions["graph"] == kChanges;
  };
  ASSERT_TRUE(fast_page.wait_for(
      fast, [&] { return done(fast_page); }, kPatience));
  PageModel slow_page;
  ASSERT_TRUE(slow_page.wait_for(
      slow, [&] { return done(slow_page); }, kPatience));
  EXPECT_EQ(slow_page.tables["graph"], fast_page.tables["graph"]);
  EXPECT_EQ(slow_page.values["scan"], fast_page.values["scan"]);
}

TEST_F(WebServer, OnlyOperatorsDriveAndAConnectionThatDropsLetsGo) {
  {
    WebSocketClient watcher(port());
    watcher.send({{"op", "drive"}, {"linear_mps", 0.5}, {"angular_radps", 0}, {"page_ms", 0}});
    PageModel page;
    ASSERT_TRUE(page.wait_for(
        watcher,
        [&] {
          return std::ranges::any_of(page.others,
                                     [](const auto& m) { return m["op"] == "refused"; });
        },
        kPatience));
    EXPECT_EQ(backend_.drives, 0);
  }
  {
    WebSocketClient operator_socket(port());
    operator_socket.send({{"op", "hello"}, {"token", kToken}});
    operator_socket.send(
        {{"op", "drive"}, {"linear_mps", 0.5}, {"angular_radps", 0}, {"page_ms", 0}});
    ASSERT_TRUE(test::wait_for("a command to drive", [&] { return backend_.drives > 0; }));
    EXPECT_EQ(backend_.speed_mps, 0.5);
    EXPECT_EQ(backend_.releases, 0);
  }
  EXPECT_TRUE(test::wait_for("the release of the robot", [&] { return backend_.releases > 0; }));
}

TEST_F(WebServer, OrdersThatQueuedUpAreNotObeyed) {
  WebSocketClient page(port(), test::token_header(kToken));
  const auto drive = [&](double linear_mps, double page_ms) {
    page.send(
        {{"op", "drive"}, {"linear_mps", linear_mps}, {"angular_radps", 0}, {"page_ms", page_ms}});
  };
  // The service's clock is stopped, so all commands arrive at once.
  drive(0.1, 7000.0);
  drive(0.2, 6800.0);
  drive(0.3, 1000.0);
  drive(0.4, 6699.0);
  drive(0.5, 7100.0);
  ASSERT_TRUE(test::wait_for("the last order", [&] { return backend_.speed_mps == 0.5; }));
  EXPECT_EQ(backend_.drives, 3) << "those of 0.1, 0.2 and 0.5 m/s";
  EXPECT_EQ(refused("late"), 2U);
}

TEST_F(WebServer, GarbageIsRefusedCountedAndInTheEndNotHeardAnyMore) {
  WebSocketClient socket(port());
  for (int i = 0; i < 40; ++i) socket.send_text("garbage " + std::to_string(i));
  PageModel page;
  EXPECT_TRUE(page.wait_for(
      socket, [&] { return socket.ended(); }, kPatience));
  EXPECT_GT(refused("no message"), 15U);
  WebSocketClient large(port());
  large.send_text(std::string(10'000, ' '));
  EXPECT_TRUE(page.wait_for(
      large, [&] { return large.ended(); }, kPatience));
  EXPECT_TRUE(
      test::wait_for("the refusal of a large message", [&] { return refused("too large") == 1; }));
}

TEST_F(WebServer, ViewersAreCountedAndLimited) {
  server_.reset();
  config_.most_viewers = 20;
  start();
  std::vector<std::unique_ptr<WebSocketClient>> sockets;
  sockets.reserve(20);
  for (int i = 0; i < 20; ++i) sockets.push_back(std::make_unique<WebSocketClient>(port()));
  EXPECT_THROW(WebSocketClient{port()}, std::runtime_error);
  EXPECT_EQ(refused("too many viewers"), 1U);
  PageModel page;
  EXPECT_TRUE(page.wait_for(
      *sockets.back(),
      [&] { return page.has("viewers") && page.values["viewers"]["viewers"] == 20; }, kPatience));
  sockets.erase(sockets.begin(), sockets.end() - 1);
  EXPECT_TRUE(page.wait_for(
      *sockets.back(), [&] { return page.values["viewers"]["viewers"] == 1; }, kPatience));
}

TEST_F(WebServer, ATakenPortIsNamed) {
  config_.port = port();
  EXPECT_THAT([this] { const Server other(config_, hub_, files_, backend_, tally_, feed_); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr(std::to_string(config_.port))));
}

TEST_F(WebServer, ACertificateThatIsNoneIsNamed) {
  config_.certificate_file = "/dev/null";
  config_.key_file = "/dev/null";
  EXPECT_THAT([this] { const Server other(config_, hub_, files_, backend_, tally_, feed_); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("/dev/null")));
}

TEST(PageFiles, AreThoseOfAFolder) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "page_files";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder / "images");
  EXPECT_THROW(PageFiles{folder}, std::runtime_error) << "without an index";
  std::ofstream(folder / "index.html") << "index";
  std::ofstream(folder / "panel.html") << "panel";
  std::ofstream(folder / "images/a.svg") << std::string(1000, ' ');
  std::ofstream(folder.parent_path() / "secret") << "secret";
  const PageFiles files(folder);
  EXPECT_EQ(files.find("/")->content, "index");
  EXPECT_EQ(files.find("/panel")->content, "panel");
  EXPECT_EQ(files.find("/images/a.svg")->content_type, "image/svg+xml");
  EXPECT_LT(files.find("/images/a.svg")->compressed.size(), 100U);
  EXPECT_EQ(files.find("/../secret"), nullptr);
  EXPECT_EQ(files.find("/images/../../secret"), nullptr);
  EXPECT_THROW(PageFiles("/nowhere"), std::runtime_error);
}

}  // namespace
}  // namespace topogeo::web
