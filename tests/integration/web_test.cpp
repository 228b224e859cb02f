// The web service in the hands of pages: on a stored map, and on a simulated robot.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "program.hpp"
#include "web_client.hpp"
#include "web_programs.hpp"

namespace topogeo::test {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::Not;

TEST(WebOnLog, ThePageStaysWithTheMapUntilCtrlC) {
  use_udp_only();
  const Scratch scratch;
  write_log("room", scratch / "room.clf");
  const std::string out = (scratch / "out").string();
  Program run(scratch, "topogeo",
              {"run", "--log", (scratch / "room.clf").string(), "--out", out, "--workers", "1",
               "--domain", own_domain(), "--web", "--port", "0", "--token", kToken});
  run.wait_for_error_text("the page runs until Ctrl-C");
  ASSERT_TRUE(std::filesystem::exists(scratch / "out/map.pb"));
  const std::uint32_t port = port_in(run.err());
  WebSocketClient socket(port);
  socket.send({{"op", "hello"}});
  PageModel page;
  EXPECT_TRUE(page.wait_for(
      socket, [&] { return page.tables["graph"].contains("map"); }, kPagePatience));
  run.send_signal(SIGINT);
  EXPECT_EQ(run.wait(), 0) << run.err();
  EXPECT_THAT(run.out(), HasSubstr("results in " + out));
  EXPECT_TRUE(std::filesystem::exists(scratch / "out/report.json"));
  // No log contains the token, and only the owner can read the file that does.
  for (const std::string& text : {run.out(), run.err(), read_file(scratch / "out/logs/web.log")}) {
    EXPECT_THAT(text, Not(HasSubstr(kToken)));
  }
  EXPECT_THAT(read_file(scratch / "out/logs/web.link"), HasSubstr("#token=" + std::string(kToken)));
  for (const char* file : {"out/logs/web.link", "out/logs/web.log", "out/logs/map_store.log"}) {
    EXPECT_EQ(std::filesystem::status(scratch / file).permissions(),
              std::filesystem::perms::owner_read | std::filesystem::perms::owner_write)
        << file;
  }
}

TEST_F(WebOnMap, APageHasTheMapThroughRestartsOfBothSides) {
  PageModel page;
  auto socket = std::make_unique<WebSocketClient>(port_);
  socket->send({{"op", "hello"}});
  ASSERT_TRUE(page.wait_for(
      *socket, [&] { return is_whole(page); }, kPagePatience));
  const auto graph = page.tables["graph"];
  const json summary = graph.at("map");
  EXPECT_EQ(graph.size() - 1,
            summary["nodes"].get<std::size_t>() + summary["branches"].get<std::size_t>());
  EXPECT_GT(summary["nodes"], 3);
  const std::string life = page.others.at(0)["life"];

  // The map store dies: its map stays, and its row shows that and its last report.
  const auto store_row = [&]() -> json {
    for (const auto& [id, row] : page.tables["services"]) {
      if (row["service"] == "map_store") return row;
    }
    return {};
  };
  ASSERT_TRUE(page.wait_for(
      *socket, [&] { return store_row().is_object(); }, kPagePatience));
  const json row = store_row();
  store_->send_signal(SIGKILL);
  store_->wait();
  ASSERT_TRUE(page.wait_for(
      *socket, [&] { return store_row()["state"] == "lost"; }, kPagePatience));
  EXPECT_EQ(store_row().size(), row.size()) << store_row();
  EXPECT_EQ(store_row()["version"], row["version"]);

  // That is an alarm until somebody acknowledges it.
  ASSERT_TRUE(page.wait_for(
      *socket, [&] { return page.tables["alarms"].size() == 1; }, kPagePatience));
  const std::string number = page.tables["alarms"].begin()->first;
  const std::string acknowledged = R"({"acknowledge":[)" + number + "]}";
  EXPECT_EQ(http_post(port_, "/api/alarms", "", acknowledged).status, 401);
  EXPECT_EQ(page.tables["alarms"][number]["acknowledged_by"], "");
  EXPECT_EQ(http_post(port_, "/api/alarms", kToken, acknowledged).status, 202);
  ASSERT_TRUE(page.wait_for(
      *socket, [&] { return page.tables["alarms"][number]["acknowledged_by"] == "a program"; },
      kPagePatience));

  // It restarts with the same map.
  start_store();
  ASSERT_TRUE(page.wait_for(
      *socket,
      [&] { return page.values["map"]["frame"].dump() != R"("")" && page.versions["tiles"] > 1; },
      kPagePatience));
  PageModel late;
  WebSocketClient late_socket(port_);
  ASSERT_TRUE(late.wait_for(
      late_socket, [&] { return is_whole(late); }, kPagePatience));
  EXPECT_EQ(late.tables["graph"], page.tables["graph"]);
  EXPECT_EQ(late.tables["rooms"], page.tables["rooms"]);

  // The web service dies: a page that holds data of its previous life gets everything anew.
  web_->send_signal(SIGKILL);
  web_->wait();
  start_web();
  socket = std::make_unique<WebSocketClient>(port_);
  socket->send({{"op", "hello"}, {"life", life}, {"have", page.versions}});
  PageModel again;
  ASSERT_TRUE(again.wait_for(
      *socket, [&] { return is_whole(again); }, kPagePatience));
  EXPECT_EQ(again.tables["graph"].size(), graph.size());
  EXPECT_NE(again.others.at(0)["life"], life);
}

// No base reports the stop, as with a robot of ROS.
TEST_F(WebOnMap, AStopOutlivesAKilledServiceUntilTheRelease) {
  EXPECT_EQ(http_post(port_, "/api/stop", kToken).status, 503) << "no base hears it";
  web_->send_signal(SIGKILL);
  web_->wait();
  start_web();
  PageModel page;
  WebSocketClient socket(port_);
  // A page gets channel `drive` before the map.
  ASSERT_TRUE(page.wait_for(
      socket, [&] { return is_whole(page); }, kPagePatience));
  ASSERT_TRUE(page.has("drive"));
  EXPECT_EQ(page.values["drive"]["stopped"], true);
  const HttpReply release = http_post(port_, "/api/release", kToken);
  EXPECT_EQ(release.status, 202);
  EXPECT_THAT(release.body, HasSubstr("no base reports the release"));
  EXPECT_TRUE(page.wait_for(
      socket, [&] { return page.values["drive"].is_null(); }, kPagePatience));
  const HttpReply again = http_post(port_, "/api/release", kToken);
  EXPECT_EQ(again.status, 503) << "neither a base nor this service holds the robot";
}

TEST_F(WebOnMap, TilesAreThoseOfTheMap) {
  PageModel page;
  WebSocketClient socket(port_);
  ASSERT_TRUE(page.wait_for(
      socket, [&] { return is_whole(page); }, kPagePatience));
  const std::string frame = page.values["map"]["frame"];
  const HttpReply tile = http_get(port_, "/tiles/grid/" + frame + "/0/0/0.png?v=1");
  EXPECT_EQ(tile.status, 200);
  EXPECT_THAT(tile.head, HasSubstr("immutable"));
  EXPECT_EQ(tile.body.substr(1, 3), "PNG");
  EXPECT_EQ(http_get(port_, "/tiles/rooms/" + frame + "/1/0/0.png").status, 200);
  EXPECT_EQ(http_get(port_, "/tiles/grid/00000000/0/0/0.png").status, 404);
  const json room = page.tables["rooms"].begin()->second;
  const std::string at = "x_m=" + room["x_m"].dump() + "&y_m=" + room["y_m"].dump();
  const json point = json::parse(http_get(port_, "/api/at?" + at).body);
  EXPECT_EQ(point["room"], room["name"]);
  EXPECT_EQ(point["cell"], "free");
}

TEST_F(WebOnMap, OrdersThatCannotBeHaveAReason) {
  PageModel page;
  WebSocketClient socket(port_);
  ASSERT_TRUE(page.wait_for(
      socket, [&] { return is_whole(page); }, kPagePatience));
  EXPECT_EQ(http_post(port_, "/api/goal", "", R"({"place":"room A"})").status, 401);
  EXPECT_EQ(http_post(port_, "/api/goal", kToken, R"({"place":"nowhere"})").status, 409);
  EXPECT_EQ(http_post(port_, "/api/goal", kToken, "nonsense").status, 400);
  EXPECT_EQ(http_post(port_, "/api/nothing", kToken).status, 404);
  EXPECT_EQ(http_post(port_, "/api/preview", kToken, R"({"x_m":1,"y_m":1})").status, 409)
      << "there is no robot";
  EXPECT_EQ(http_post(port_, "/api/search", kToken).status, 503) << "there is no localizer";
  const json info = json::parse(http_get(port_, "/api/info").body);
  EXPECT_EQ(info["protocol"], 1);
  EXPECT_THAT(info["offers"], testing::Contains("goal"));
}

TEST_F(WebOnMap, OneMapIsMergedAtATime) {
  PageModel page;
  WebSocketClient socket(port_);
  ASSERT_TRUE(page.wait_for(
      socket, [&] { return is_whole(page); }, kPagePatience));
  const std::string file = read_file(scratch_ / "room/map.pb");
  const auto offer = [&] {
    return http_request(
        port_, "POST", "/api/merge_map",
        {{"Authorization", "Bearer " + kToken}, {"Content-Type", "application/octet-stream"}},
        file);
  };
  constexpr std::size_t kAtOnce = 6;
  std::size_t worked_on = 0;
  std::size_t busy = 0;
  const auto offer_at_once = [&] {
    std::vector<std::future<HttpReply>> offers;
    while (offers.size() < kAtOnce) offers.push_back(std::async(std::launch::async, offer));
    for (std::future<HttpReply>& one : offers) {
      const HttpReply reply = one.get();
      EXPECT_EQ(reply.status, 409) << reply.body;
      if (reply.body.find("another merge is in progress") != std::string::npos) ++busy;
      if (reply.body.find("one is an earlier state of the other") != std::string::npos) ++worked_on;
    }
  };
  ASSERT_TRUE(test::wait_for(
      "two offers to meet", [&] { return busy > 0; }, offer_at_once));
  EXPECT_GE(worked_on, 1U);
  EXPECT_THAT(offer().body, HasSubstr("one is an earlier state of the other"))
      << "it is free again";
}

/// Makes room/map.pb.
void map_room(const Scratch& scratch) {
  write_log("room", scratch / "room.clf");
  Program map(
      scratch, "topogeo",
      {"map", "--log", (scratch / "room.clf").string(), "--out", (scratch / "room").string()});
  ASSERT_EQ(map.wait(), 0) << map.err();
}

TEST(WebCommand, ViewsAStoredMap) {
  use_udp_only();
  const Scratch scratch;
  ASSERT_NO_FATAL_FAILURE(map_room(scratch));
  Program view(scratch, "topogeo",
               {"view", (scratch / "room/map.pb").string(), "--port", "0", "--no-browser",
                "--domain", own_domain()});
  PageModel page;
  WebSocketClient socket(wait_for_port(view));
  EXPECT_TRUE(page.wait_for(
      socket, [&] { return page.has("tiles") && page.tables["graph"].contains("map"); },
      kPagePatience));
  view.send_signal(SIGINT);
  EXPECT_EQ(view.wait(), 0) << view.err();
}

/// Arguments of a process as in `ps`, each with a terminating zero byte.
std::string command_line_of(pid_t process) {
  return read_file("/proc/" + std::to_string(process) + "/cmdline");
}

TEST(WebCommand, HidesATokenOfTheCommandLine) {
  use_udp_only();
  const Scratch scratch;
  const std::string domain = own_domain();
  Program web(scratch, "web", {"--domain", domain, "--port", "0", "--token", kToken});
  wait_for_port(web);
  EXPECT_THAT(web.out(), HasSubstr(kToken));
  EXPECT_THAT(command_line_of(web.pid()),
              testing::AllOf(HasSubstr("--token"), Not(HasSubstr(kToken))));
  EXPECT_THAT(web.err(), HasSubstr("use --token-file or TOPOGEO_WEB_TOKEN"));
  Program command(scratch, "topogeo",
                  {"web", "--domain", domain, "--port", "0", "--token", kToken});
  wait_for_port(command);
  EXPECT_THAT(command_line_of(command.pid()), Not(HasSubstr(kToken)));
  EXPECT_THAT(command.err(), HasSubstr("use --token-file or TOPOGEO_WEB_TOKEN"));
}

TEST(WebCommand, TakesTheTokenOfAFile) {
  use_udp_only();
  const Scratch scratch;
  std::ofstream(scratch / "token") << kToken << '\n';
  const std::string token = (scratch / "token").string();
  Program web(scratch, "topogeo",
              {"web", "--domain", own_domain(), "--port", "0", "--token-file", token});
  wait_for_port(web);
  EXPECT_THAT(web.out(), HasSubstr("#token=" + std::string(kToken)));
  EXPECT_THAT(command_line_of(web.pid()), Not(HasSubstr(kToken)));
  EXPECT_THAT(web.err(), Not(HasSubstr("--token-file")));
  for (const char* command : {"web", "run"}) {
    std::vector<std::string> words = {command, "--token-file", (scratch / "none").string()};
    if (words.front() == "run") words.insert(words.end(), {"--log", "l", "--out", "o", "--web"});
    Program missing(scratch, "topogeo", words);
    EXPECT_EQ(missing.wait(), 3) << command;
    EXPECT_THAT(missing.err(), HasSubstr("none")) << command;
  }
}

// The browser's arguments are visible, too.
TEST(WebCommand, OpensABrowserWithoutTheTokenInItsArguments) {
  use_udp_only();
  const Scratch scratch;
  ASSERT_NO_FATAL_FAILURE(map_room(scratch));
  const std::filesystem::path opened = scratch / "opened";
  std::ofstream(scratch / "xdg-open") << "#!/bin/sh\n{ printf '%s\\n' \"$1\"; stat -c %a "
                                         "\"${1#file://}\"; cat \"${1#file://}\"; } > '"
                                      << opened.string() << ".new'\nmv '" << opened.string()
                                      << ".new' '" << opened.string() << "'\n";
  std::filesystem::permissions(scratch / "xdg-open", std::filesystem::perms::owner_all);
  const std::string path = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe): one thread
  ::setenv("PATH", (scratch / "").string().append(":").append(path).c_str(), 1);  // NOLINT
  ::setenv("DISPLAY", ":7", 1);  // NOLINT(concurrency-mt-unsafe): as above
  Program view(
      scratch, "topogeo",
      {"view", (scratch / "room/map.pb").string(), "--port", "0", "--domain", own_domain()});
  ::setenv("PATH", path.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): as above
  ::unsetenv("DISPLAY");              // NOLINT(concurrency-mt-unsafe): as above
  ASSERT_TRUE(test::wait_for("a browser", [&] { return std::filesystem::exists(opened); }));
  const std::string all = read_file(opened);
  const std::string argument = all.substr(0, all.find('\n'));
  EXPECT_THAT(argument, testing::AllOf(testing::StartsWith("file:///"), Not(HasSubstr("token"))));
  EXPECT_THAT(all, testing::AllOf(HasSubstr("\n600\n"), HasSubstr("#token=")));
}

TEST(WebCommand, NamesWhatDoesNotGoTogether) {
  const Scratch scratch;
  Program open(scratch, "web", {"--bind", "0.0.0.0", "--port", "0"});
  EXPECT_EQ(open.wait(), 2);
  EXPECT_THAT(open.err(), HasSubstr("--certificate"));
  Program short_token(scratch, "web", {"--token", "short"});
  EXPECT_EQ(short_token.wait(), 2);
  Program no_page(scratch, "web", {"--page", "/nowhere", "--port", "0"});
  EXPECT_EQ(no_page.wait(), 1);
  EXPECT_THAT(no_page.err(), HasSubstr("/nowhere"));
  Program no_map(scratch, "topogeo", {"view", "/nowhere.pb"});
  EXPECT_EQ(no_map.wait(), 3);
}

TEST_F(WebOnRobot, GoesToARoomByNameAndStopsWhenTheHandLetsGo) {
  ASSERT_TRUE(wait_for([&] {
    return page_.has("pose") && page_.values["pose"]["state"] == "TRACKING" && page_.has("truth") &&
           page_.tables["places"].contains("room A") && page_.has("navigator");
  })) << demo_->err();
  const auto start = truth();
  const double start_rad = page_.values["truth"]["theta_rad"];

  const HttpReply preview = http_post(port_, "/api/preview", kToken, R"({"place":"room A"})");
  ASSERT_EQ(preview.status, 200) << preview.body;
  const json route = json::parse(preview.body);
  ASSERT_EQ(route["found"], true) << preview.body;
  EXPECT_GT(route["length_m"], 1.0);
  EXPECT_GT(route["time_s"], 1.0);

  ASSERT_EQ(http_post(port_, "/api/goal", kToken, R"({"place":"Room a"})").status, 202);
  ASSERT_TRUE(wait_for([&] { return page_.values["navigator"]["state"] == "driving"; }));
  ASSERT_TRUE(wait_for([&] {
    return page_.values["navigator"]["state"] == "arrived" &&
           page_.values["goals"]["current"].is_null();
  }));
  const json place = page_.tables["places"]["room A"];
  const double x_m = place["x_m"];
  const double y_m = place["y_m"];
  const std::pair<double, double> goal = {
      start.first + std::cos(start_rad) * x_m - std::sin(start_rad) * y_m,
      start.second + std::sin(start_rad) * x_m + std::cos(start_rad) * y_m};
  EXPECT_LT(distance(truth(), goal), 0.3);

  // Driven by hand, the robot turns, which nothing can obstruct; then the connection drops.
  const double before_rad = page_.values["truth"]["theta_rad"];
  {
    WebSocketClient hand(port_);
    hand.send({{"op", "hello"}, {"token", kToken}});
    const auto turned = [&] {
      return std::fabs(std::remainder(page_.values["truth"]["theta_rad"].get<double>() - before_rad,
                                      2.0 * std::numbers::pi)) > 0.3;
    };
    // The status shows it only while orders come in time, which a busy machine may miss once.
    bool held = false;
    EXPECT_TRUE(test::wait_for(
        "the robot to turn by hand", [&] { return turned() && held; },
        [&] {
          hand.send({{"op", "drive"},
                     {"linear_mps", 0.0},
                     {"angular_radps", 0.5},
                     {"page_ms", page_ms()}});
          wait_for([] { return false; }, milliseconds(50));  // between two commands by hand
          const json& drive = page_.values["drive"];
          held = held || (!drive.is_null() && drive["held"] == true);
        }));
  }
  ASSERT_TRUE(wait_for([&] { return page_.values["drive"].is_null(); }));
  // The robot stands: for a second of its own time its heading stays the same.
  const auto heading_rad = [&] { return page_.values["truth"]["theta_rad"].get<double>(); };
  const auto time_s = [&] { return page_.values["pose"]["stamp_s"].get<double>(); };
  ASSERT_TRUE(wait_for([&] { return page_.values["pose"].is_object(); }));
  double stood_rad = heading_rad();
  double since_s = time_s();
  ASSERT_TRUE(wait_for([&] {
    if (!page_.values["pose"].is_object()) return false;
    if (std::fabs(heading_rad() - stood_rad) > 1e-9) {
      stood_rad = heading_rad();
      since_s = time_s();
    }
    return time_s() >= since_s + 1.0;
  }));
  EXPECT_EQ(page_.values["truth"]["collisions"], 0);

  // The stop button holds the base until it is released.
  ASSERT_EQ(http_post(port_, "/api/stop", kToken).status, 202);
  ASSERT_TRUE(wait_for([&] { return page_.values["base"]["state"] == "halted"; }));
  ASSERT_EQ(http_post(port_, "/api/release", kToken).status, 202);
  ASSERT_TRUE(wait_for([&] { return page_.values["base"]["state"] == "ready"; }));

  demo_->send_signal(SIGINT);
  EXPECT_EQ(demo_->wait(), 0) << demo_->err();
}

}  // namespace
}  // namespace topogeo::test
