// A drawing from the page: kept by the map store, obeyed by the robot, simulated as a floor.
#include <chrono>
#include <cmath>
#include <csignal>
#include <string>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "web_programs.hpp"

namespace topogeo::test {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using testing::HasSubstr;

json drawing_at(std::uint32_t port) {
  const HttpReply reply = http_get(port, "/api/drawing");
  return reply.status == 200 ? json::parse(reply.body) : json{};
}

HttpReply draw(std::uint32_t port, const json& drawing) {
  return http_post(port, "/api/drawing", kToken, drawing.dump());
}

/// Polls until the drawing has this version; it is published on a topic of its own.
bool has_version(std::uint32_t port, const std::string& version) {
  return test::wait_for("version " + version + " of the drawing", [&] {
    const json drawing = drawing_at(port);
    return drawing.is_object() && drawing["version"] == version;
  });
}

TEST(DrawingStore, KeepsWhatItHasAnsweredThroughAKill) {
  use_udp_only();
  const Scratch scratch;
  const std::string domain = own_domain();
  const auto store = [&] {
    return std::make_unique<Program>(
        scratch, "map_store",
        std::vector<std::string>{"--domain", domain, "--out", (scratch / "kept").string()});
  };
  auto keeper = store();
  Program web(scratch, "web", {"--domain", domain, "--port", "0", "--token", kToken});
  const std::uint32_t port = wait_for_port(web);
  ASSERT_TRUE(has_version(port, "0"));
  EXPECT_EQ(http_post(port, "/api/drawing", "", "{}").status, 401);
  const json drawn = {
      {"version", "0"},
      {"places", {{{"name", "kitchen"}, {"x_m", 1.25}, {"y_m", 1.0 / 3.0}}}},
      {"zones",
       {{{"name", "wet"}, {"kind", "no_go"}, {"value", 0}, {"corners_m", {0, 0, 1, 0, 1, 1}}}}},
      {"walls", {{{"points_m", {0, 0, 4, 0, 4, 3}}}}},
      {"openings", {{{"points_m", {1, 0, 2, 0}}}}},
      {"doors", {{{"name", "front door"}, {"points_m", {4, 1, 4, 2}}}}}};
  HttpReply reply = draw(port, drawn);
  ASSERT_EQ(reply.status, 200) << reply.body;
  EXPECT_EQ(json::parse(reply.body)["version"], "1");
  reply = draw(port, drawn);
  EXPECT_EQ(reply.status, 409) << reply.body;
  EXPECT_EQ(json::parse(reply.body)["version"], "1");
  reply = draw(port, {{"version", "1"}, {"walls", {{{"points_m", {0, 0}}}}}});
  EXPECT_EQ(reply.status, 400);
  EXPECT_THAT(reply.body, HasSubstr("walls[0]"));

  keeper->send_signal(SIGKILL);
  keeper->wait();
  keeper = store();
  json changed = drawn;
  changed["version"] = "1";
  changed["walls"] = json::array();
  ASSERT_TRUE(test::wait_for("the new map store", [&] {
    reply = draw(port, changed);
    return reply.status != 503;
  }));
  ASSERT_EQ(reply.status, 200) << "it was version 1 before and after: " << reply.body;
  ASSERT_TRUE(has_version(port, "2"));
  json kept = drawing_at(port);
  EXPECT_EQ(kept["places"], drawn["places"]) << "to the last digit";
  EXPECT_EQ(kept["doors"], drawn["doors"]);
  EXPECT_TRUE(kept["walls"].empty());
}

using DrawingOnRobot = WebOnRobot;

TEST_F(DrawingOnRobot, IsObeyedAndAFloorIsDrivenIn) {
  const auto tracks = [&] {
    return page_.has("pose") && page_.values["pose"]["state"] == "TRACKING" && page_.has("truth") &&
           page_.has("navigator") && page_.has("rooms");
  };
  ASSERT_TRUE(wait_for(tracks)) << demo_->err();
  const auto preview = [&] {
    return json::parse(http_post(port_, "/api/preview", kToken, R"({"x_m":7.5,"y_m":0})").body);
  };
  const auto set_rules = [&](json drawing, bool ruled) {
    drawing["version"] = drawing_at(port_)["version"];
    const HttpReply reply = draw(port_, drawing);
    EXPECT_EQ(reply.status, 200) << reply.body;
    EXPECT_TRUE(wait_for([&] { return page_.tables["rules"].contains("wet") == ruled; }));
  };
  json drawing = drawing_at(port_);
  ASSERT_TRUE(drawing.is_object());

  // A no-go zone across the corridor: the route avoids it, or there is none. Without it: through.
  const json through = preview();
  ASSERT_EQ(through["found"], true) << through;
  EXPECT_NEAR(through["length_m"].get<double>(), 7.5, 0.5);
  drawing["zones"] = {{{"name", "wet"},
                       {"kind", "no_go"},
                       {"value", 0},
                       {"corners_m", {3.0, -3.0, 4.0, -3.0, 4.0, 3.0, 3.0, 3.0}}}};
  set_rules(drawing, true);
  const json round = preview();
  EXPECT_TRUE(round["found"] == false || round["length_m"].get<double>() > 12.0) << round;

  // Driven by hand, the robot gets to the zone and no further.
  const double start_m = page_.values["truth"]["x_m"];
  const auto driven_m = [&] { return page_.values["truth"]["x_m"].get<double>() - start_m; };
  const auto holds = [&] {
    const json& drive = page_.values["drive"];
    return drive.is_object() && drive["linear_mps"] == 0.0 &&
           drive["message"].dump().find("drawn wall or no-go") != std::string::npos;
  };
  const bool held = test::wait_for("the zone to hold a robot that is driven by hand", holds, [&] {
    socket_->send(
        {{"op", "drive"}, {"linear_mps", 0.5}, {"angular_radps", 0.0}, {"page_ms", page_ms()}});
    wait_for([] { return false; }, milliseconds(50));  // between two commands by hand
  });
  EXPECT_TRUE(held) << page_.values["drive"];
  EXPECT_GT(driven_m(), 2.0);
  EXPECT_LT(driven_m(), 3.0 - 0.25);
  socket_->send({{"op", "release"}});
  drawing["zones"] = json::array();
  set_rules(drawing, false);
  EXPECT_NEAR(preview()["length_m"].get<double>(), 7.5 - driven_m(), 0.5);

  // Two rooms of 4 x 4 m with a door, and a robot in the left one.
  const json floor = {
      {"target", "simulator"},
      {"name", "two rooms"},
      {"start", {{"x_m", 1.0}, {"y_m", 2.0}, {"heading_rad", 0.0}}},
      {"walls", {{{"points_m", {0, 0, 8, 0, 8, 4, 0, 4, 0, 0}}}, {{"points_m", {4, 0, 4, 4}}}}},
      {"doors", {{{"name", "door"}, {"points_m", {4, 1.3, 4, 2.5}}}}},
      {"places", {{{"name", "right room"}, {"x_m", 6.5}, {"y_m", 1.0}}}}};
  const json info = json::parse(http_get(port_, "/api/info").body);
  ASSERT_THAT(info["offers"], testing::Contains("floor"));
  EXPECT_EQ(http_post(port_, "/api/floor", "", floor.dump()).status, 401);
  json in_wall = floor;
  in_wall["start"]["x_m"] = 4.0;
  in_wall["start"]["y_m"] = 3.5;
  EXPECT_EQ(http_post(port_, "/api/floor", kToken, in_wall.dump()).status, 400);
  const HttpReply loaded = http_post(port_, "/api/floor", kToken, floor.dump());
  ASSERT_EQ(loaded.status, 202) << loaded.body;
  ASSERT_TRUE(wait_for([&] {
    return page_.tables["places"].contains("right room") && distance(truth(), {1.0, 2.0}) < 0.1 &&
           page_.values["pose"]["state"] == "TRACKING" &&
           std::fabs(page_.values["pose"]["x_m"].get<double>()) < 0.1 &&
           page_.tables["rooms"].size() == 2;
  })) << demo_->err();
  EXPECT_EQ(page_.tables["graph"]["map"]["map_id"].is_null(), false);
  ASSERT_EQ(http_post(port_, "/api/goal", kToken, R"({"place":"right room"})").status, 202);
  ASSERT_TRUE(wait_for([&] {
    return page_.values["navigator"]["state"] == "arrived" &&
           page_.values["goals"]["current"].is_null();
  })) << page_.values["navigator"];
  EXPECT_LT(distance(truth(), {6.5, 1.0}), 0.3);
  EXPECT_EQ(page_.values["truth"]["collisions"], 0);
  EXPECT_EQ(http_get(port_, "/api/info").status, 200) << "the page has stayed";

  demo_->send_signal(SIGINT);
  EXPECT_EQ(demo_->wait(), 0) << demo_->err();
}

}  // namespace
}  // namespace topogeo::test
