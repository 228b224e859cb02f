// Topics, frames and messages of Foxglove's protocol.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "foxglove/foxglove_feed.hpp"
#include "foxglove/foxglove_scene.hpp"
#include "foxglove/foxglove_topics.hpp"
#include "foxglove/foxglove_view.hpp"
#include "foxglove/foxglove_viewer.hpp"

namespace topogeo::web {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::SizeIs;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// Decodes plain base64 with padding.
std::string decoded(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned held = 0;
  int bits = 0;
  for (const char letter : text) {
    if (letter == '=') break;
    held = (held << 6U) | static_cast<unsigned>(letters.find(letter));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>((held >> static_cast<unsigned>(bits)) & 0xffU);
  }
  return bytes;
}

json schema_of(const json& channel) {
  return json::parse(channel["schema"].get<std::string>());
}

/// Expects that a message has only members of the schema, with its types.
void expect_fits(const json& message, const json& schema, const std::string& where) {
  const std::string type = schema.value("type", "");
  if (type == "object") {
    ASSERT_TRUE(message.is_object()) << where;
    for (const auto& [key, value] : message.items()) {
      ASSERT_TRUE(schema["properties"].contains(key)) << where << "." << key;
      expect_fits(value, schema["properties"][key], std::string(where).append(".").append(key));
    }
    EXPECT_EQ(message.size(), schema["properties"].size()) << where;
  } else if (type == "array") {
    ASSERT_TRUE(message.is_array()) << where;
    for (const json& item : message) expect_fits(item, schema["items"], where + "[]");
  } else if (type == "number") {
    EXPECT_TRUE(message.is_number()) << where;
  } else if (type == "integer") {
    EXPECT_TRUE(message.is_number_integer()) << where;
  } else if (type == "boolean") {
    EXPECT_TRUE(message.is_boolean()) << where;
  } else if (type == "string") {
    EXPECT_TRUE(message.is_string()) << where;
  } else {
    bool found = false;
    for (const json& choice : schema["oneOf"]) found = found || choice["const"] == message;
    EXPECT_TRUE(found) << where << ": " << message;
  }
}

void expect_fits(const std::string& message, const std::string& type) {
  expect_fits(json::parse(message), json::parse(foxglove_schema(type)), type);
}

TEST(FoxgloveTopics, AreAdvertisedWithTheirSchemas) {
  const json message = json::parse(advertisement());
  EXPECT_EQ(message["op"], "advertise");
  std::set<std::uint32_t> ids;
  std::set<std::string> topics;
  for (const json& channel : message["channels"]) {
    ids.insert(channel["id"].get<std::uint32_t>());
    topics.insert(channel["topic"]);
    EXPECT_EQ(channel["encoding"], "json");
    EXPECT_EQ(channel["schemaEncoding"], "jsonschema");
    EXPECT_EQ(schema_of(channel)["title"], channel["schemaName"]);
    EXPECT_EQ(schema_of(channel)["type"], "object");
  }
  EXPECT_EQ(ids.size(), kFoxgloveTopics);
  EXPECT_EQ(topics.size(), kFoxgloveTopics);
  EXPECT_EQ(foxglove_topic(4)->name, "/map");
  EXPECT_EQ(foxglove_topic(0), nullptr);
  EXPECT_EQ(foxglove_topic(99), nullptr);
}

TEST(FoxgloveProtocol, TheNewerSubprotocolIsChosen) {
  EXPECT_EQ(foxglove_subprotocol("foxglove.websocket.v1"), "foxglove.websocket.v1");
  EXPECT_EQ(foxglove_subprotocol("foxglove.sdk.v1"), "foxglove.sdk.v1");
  EXPECT_EQ(foxglove_subprotocol("foxglove.websocket.v1 , foxglove.sdk.v1"), "foxglove.sdk.v1");
  EXPECT_EQ(foxglove_subprotocol("chat,\tfoxglove.websocket.v1"), "foxglove.websocket.v1");
  for (const char* other : {"", "chat", "foxglove.sdk.v2", ",", " , ", "xfoxglove.sdk.v1"}) {
    EXPECT_EQ(foxglove_subprotocol(other), "") << other;
  }
}

TEST(FoxgloveProtocol, AMessageIsLittleEndianBehindItsOpcode) {
  const std::string bytes = message_data(0x01020304, 0x1112131415161718, "{}");
  EXPECT_EQ(bytes, std::string("\x01\x04\x03\x02\x01\x18\x17\x16\x15\x14\x13\x12\x11{}"));
}

TEST(FoxgloveScene, NodesAreSpheresAndBranchesLines) {
  ChannelHub hub;
  hub.edit(Channel::kGraph,
           {{"n1", R"({"kind":"door","x_m":1.5,"y_m":-2,"clearance_m":0.4,"seen":3})"},
            {"b2", R"({"a":1,"b":3,"virtual":false,"seen":1,"points_m":[0,0,1,0,1,2]})"},
            {"map", R"({"map_id":"00","version":"7","nodes":1,"branches":1})"}});
  const auto first =
      foxglove_messages(Channel::kGraph, *hub.update(Channel::kGraph, 0).text, kSecond_ns);
  ASSERT_EQ(first.size(), 1U);
  expect_fits(first[0], "foxglove.SceneUpdate");
  const json all = json::parse(first[0]);
  ASSERT_THAT(all["deletions"], SizeIs(1));
  EXPECT_EQ(all["deletions"][0]["type"], 1) << "all that was there before";
  ASSERT_THAT(all["entities"], SizeIs(2)) << "the summary has nothing to see";
  const json& branch = all["entities"][0];
  EXPECT_EQ(branch["id"], "b2");
  EXPECT_EQ(branch["frame_id"], "map");
  EXPECT_EQ(branch["timestamp"], json::parse(R"({"sec":1,"nsec":0})"));
  EXPECT_EQ(branch["lines"][0]["type"], 0);
  ASSERT_THAT(branch["lines"][0]["points"], SizeIs(3));
  EXPECT_EQ(branch["lines"][0]["points"][2]["y"], 2);
  EXPECT_EQ(all["entities"][1]["spheres"][0]["pose"]["position"]["x"], 1.5);

  hub.edit(Channel::kGraph, {{"b2", ""}, {"n1", ""}, {"n4", R"({"kind":"real","x_m":0,"y_m":0})"}});
  const json delta = json::parse(
      foxglove_messages(Channel::kGraph, *hub.update(Channel::kGraph, 1).text, kSecond_ns)[0]);
  ASSERT_THAT(delta["deletions"], SizeIs(2));
  std::set<std::string> gone;
  for (const json& deletion : delta["deletions"]) {
    EXPECT_EQ(deletion["type"], 0);
    gone.insert(deletion["id"]);
  }
  EXPECT_THAT(gone, ElementsAre("b2", "n1"));
  ASSERT_THAT(delta["entities"], SizeIs(1));
  EXPECT_EQ(delta["entities"][0]["id"], "n4");
}

TEST(FoxgloveScene, WhatHasNoPlaceIsLeftOut) {
  ChannelHub hub;
  hub.edit(Channel::kGraph, {{"n1", R"({"kind":"door","x_m":null,"y_m":2})"},
                             {"n2", R"({"kind":"door"})"},
                             {"b1", R"({"a":1,"b":2,"points_m":[0,null]})"},
                             {"n3", R"({"kind":"real","x_m":1,"y_m":2})"}});
  const auto messages = foxglove_messages(Channel::kGraph, *hub.update(Channel::kGraph, 0).text, 0);
  const json entities = json::parse(messages.at(0))["entities"];
  ASSERT_THAT(entities, SizeIs(1));
  EXPECT_EQ(entities[0]["id"], "n3");
}

TEST(FoxgloveScene, RoomsPlacesAndRulesHaveTheirNames) {
  ChannelHub hub;
  hub.edit(Channel::kRooms, {{"0", R"({"name":"hall","area_m2":9,"x_m":1,"y_m":2,"color":0})"}});
  hub.edit(Channel::kPlaces, {{"desk \"A\"", R"({"x_m":3,"y_m":4})"}});
  hub.edit(Channel::kRules, {{"lab", R"({"kind":"no_go","value":0,"corners_m":[0,0,1,0,1,1]})"}});
  const auto entity = [&](Channel channel) {
    const std::string text = foxglove_messages(channel, *hub.update(channel, 0).text, 0).at(0);
    expect_fits(text, "foxglove.SceneUpdate");
    return json::parse(text)["entities"][0];
  };
  EXPECT_EQ(entity(Channel::kRooms)["texts"][0]["text"], "hall");
  const json place = entity(Channel::kPlaces);
  EXPECT_EQ(place["texts"][0]["text"], "desk \"A\"");
  EXPECT_EQ(place["spheres"][0]["pose"]["position"]["y"], 4);
  const json rule = entity(Channel::kRules);
  EXPECT_EQ(rule["lines"][0]["type"], 1) << "closed";
  EXPECT_EQ(rule["texts"][0]["text"], "lab");
}

TEST(FoxgloveScene, ARouteGoesWhenThereIsNone) {
  ChannelHub hub;
  hub.set(Channel::kRoute, R"({"goal_id":"1","found":true,"points_m":[0,0,2,1]})");
  const auto entities = [&] {
    const std::string text =
        foxglove_messages(Channel::kRoute, *hub.update(Channel::kRoute, 0).text, 0).at(0);
    expect_fits(text, "foxglove.SceneUpdate");
    EXPECT_EQ(json::parse(text)["deletions"][0]["type"], 1);
    return json::parse(text)["entities"];
  };
  EXPECT_THAT(entities(), SizeIs(1));
  hub.set(Channel::kRoute, R"({"goal_id":"1","found":false,"points_m":[]})");
  EXPECT_THAT(entities(), SizeIs(0));
  hub.set(Channel::kRoute, "null");
  EXPECT_THAT(entities(), SizeIs(0));
  EXPECT_THROW(foxglove_messages(Channel::kPose, R"({"channel":"pose","version":1,"value":{}})", 0),
               std::invalid_argument);
}

TEST(FoxgloveScene, EventsAreALogInTheirOrder) {
  ChannelHub hub;
  std::vector<Edit> events;
  for (const char* number : {"2", "10", "9"}) {
    events.push_back({number, std::string(R"({"time_s":12.5,"level":"warning","source":"base",)") +
                                  R"("text":"event )" + number + R"("})"});
  }
  hub.edit(Channel::kEvents, events);
  const auto log = foxglove_messages(Channel::kEvents, *hub.update(Channel::kEvents, 0).text, 0);
  ASSERT_EQ(log.size(), 3U);
  for (const std::string& message : log) expect_fits(message, "foxglove.Log");
  EXPECT_EQ(json::parse(log[0])["message"], "event 2");
  EXPECT_EQ(json::parse(log[2])["message"], "event 10");
  EXPECT_EQ(json::parse(log[0])["level"], 3);
  EXPECT_EQ(json::parse(log[0])["timestamp"], json::parse(R"({"sec":12,"nsec":500000000})"));
}

TEST(FoxgloveFeed, AMessageIsMadeOnceAndWhenItIsWanted) {
  FoxgloveFeed feed;
  int changes = 0;
  int made = 0;
  feed.on_change([&] { ++changes; });
  EXPECT_EQ(feed.version(LiveTopic::kScan), 0U);
  EXPECT_EQ(feed.newest(LiveTopic::kScan).version, 0U);
  for (int i = 0; i < 3; ++i) {
    feed.set(LiveTopic::kScan, [&made, i] {
      ++made;
      return std::to_string(i);
    });
  }
  EXPECT_EQ(changes, 3);
  EXPECT_EQ(made, 0);
  EXPECT_EQ(*feed.newest(LiveTopic::kScan).json, "2");
  EXPECT_EQ(*feed.newest(LiveTopic::kScan).json, "2");
  EXPECT_EQ(made, 1);
  EXPECT_EQ(feed.version(LiveTopic::kScan), 3U);
  EXPECT_EQ(feed.version(LiveTopic::kMap), 0U);
}

geometry::Pose2 pose_of(const json& transform) {
  return {transform["translation"]["x"], transform["translation"]["y"],
          2.0 * std::atan2(transform["rotation"]["z"].get<double>(),
                           transform["rotation"]["w"].get<double>())};
}

msg::LivePose live_pose(std::int64_t stamp_ns, msg::LocalizationState state,
                        const geometry::Pose2& T_map_robot) {
  msg::LivePose pose;
  pose.stamp_ns(stamp_ns);
  pose.state(state);
  pose.T_map_robot().x_m(T_map_robot.x_m);
  pose.T_map_robot().y_m(T_map_robot.y_m);
  pose.T_map_robot().theta_rad(T_map_robot.theta_rad);
  return pose;
}

TEST(FoxgloveView, FramesLeadFromTheMapToTheLaser) {
  FoxgloveFeed feed;
  const geometry::Pose2 T_robot_laser{0.2, 0.0, 0.0};
  FoxgloveView view(feed, T_robot_laser);
  const auto transforms = [&] {
    const std::string text = *feed.newest(LiveTopic::kTransforms).json;
    expect_fits(text, "foxglove.FrameTransforms");
    return json::parse(text)["transforms"];
  };
  navigation::ScanPoints scan;
  scan.stamp_ns = 5 * kSecond_ns;
  scan.T_odom_robot = {1.0, 0.0, std::numbers::pi / 2.0};
  view.take(scan);
  EXPECT_THAT(transforms(), SizeIs(2)) << "nobody knows where the robot is";

  // The robot has moved on when the pose of its scan arrives.
  msg::Odometry odometry;
  odometry.stamp_ns(6 * kSecond_ns);
  odometry.T_odom_robot().x_m(1.0);
  odometry.T_odom_robot().y_m(0.5);
  odometry.T_odom_robot().theta_rad(std::numbers::pi / 2.0);
  view.take(odometry);
  const geometry::Pose2 T_map_robot{4.0, 3.0, 0.0};
  view.take(live_pose(scan.stamp_ns, msg::kStateTracking, T_map_robot));
  const json frames = transforms();
  ASSERT_THAT(frames, SizeIs(3));
  EXPECT_EQ(frames[0]["parent_frame_id"], "map");
  EXPECT_EQ(frames[0]["child_frame_id"], "odom");
  EXPECT_EQ(frames[0]["timestamp"]["sec"], 5);
  EXPECT_EQ(frames[1]["child_frame_id"], "base_link");
  EXPECT_EQ(frames[1]["timestamp"]["sec"], 6);
  EXPECT_EQ(frames[2]["child_frame_id"], "laser");
  // 0.5 m forward since the scan, which is along x in the map.
  const geometry::Pose2 T_map_laser = pose_of(frames[0]) * pose_of(frames[1]) * pose_of(frames[2]);
  EXPECT_NEAR(T_map_laser.x_m, 4.7, 1e-9);
  EXPECT_NEAR(T_map_laser.y_m, 3.0, 1e-9);
  EXPECT_NEAR(T_map_laser.theta_rad, 0.0, 1e-9);
  const std::string pose = *feed.newest(LiveTopic::kPose).json;
  expect_fits(pose, "foxglove.PoseInFrame");
  EXPECT_EQ(json::parse(pose)["pose"]["position"]["x"], 4.0);

  // Lost: no pose is published.
  const std::uint64_t poses = feed.version(LiveTopic::kPose);
  view.take(live_pose(7 * kSecond_ns, msg::kStateLost, T_map_robot));
  odometry.stamp_ns(8 * kSecond_ns);
  view.take(odometry);
  EXPECT_THAT(transforms(), SizeIs(2));
  EXPECT_EQ(feed.version(LiveTopic::kPose), poses);

  // A restarted source.
  scan.stamp_ns = 0;
  view.take(scan);
  EXPECT_EQ(transforms()[0]["timestamp"]["sec"], 0);
}

TEST(FoxgloveView, AScanIsACloudOfPoints) {
  navigation::ScanPoints scan;
  scan.points_m = {{1.5, -2.0}, {0.25, 8.0}};
  const std::string text = point_cloud(scan);
  expect_fits(text, "foxglove.PointCloud");
  const json cloud = json::parse(text);
  EXPECT_EQ(cloud["frame_id"], "base_link");
  EXPECT_EQ(cloud["point_stride"], 12);
  const std::string bytes = decoded(cloud["data"]);
  ASSERT_EQ(bytes.size(), 24U);
  std::vector<float> numbers(6);
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  EXPECT_THAT(numbers, ElementsAre(1.5F, -2.0F, 0.0F, 0.25F, 8.0F, 0.0F));
}

TEST(FoxgloveView, AMapIsAGridOfColours) {
  planning::GridFrame frame;
  frame.columns = 3;
  frame.rows = 2;
  frame.resolution_m = 0.05;
  frame.T_map_grid = {-1.0, 2.0, 0.0};
  auto square = std::make_shared<GridSquare>();
  square->states.assign(4096, static_cast<std::uint8_t>(planning::CellState::kUnknown));
  square->zones.assign(4096, 65535);
  square->states.at(0) = static_cast<std::uint8_t>(planning::CellState::kFree);
  square->states.at(64 + 2) = static_cast<std::uint8_t>(planning::CellState::kOccupied);
  const MapPicture picture(frame, {square}, {});
  const std::string text = colored_grid(picture, Layer::kGrid, kSecond_ns);
  expect_fits(text, "foxglove.Grid");
  const json grid = json::parse(text);
  EXPECT_EQ(grid["column_count"], 3);
  EXPECT_EQ(grid["cell_size"]["x"], 0.05);
  EXPECT_EQ(grid["pose"]["position"]["x"], -1.0);
  const std::string bytes = decoded(grid["data"]);
  ASSERT_EQ(bytes.size(), 24U);
  const auto byte = [&](std::size_t cell, std::size_t part) {
    return static_cast<int>(static_cast<unsigned char>(bytes[4 * cell + part]));
  };
  EXPECT_EQ(byte(0, 0), 255) << "free is white";
  EXPECT_EQ(byte(0, 3), 255);
  EXPECT_EQ(byte(1, 3), 0) << "unknown is transparent";
  EXPECT_EQ(byte(5, 0), 32) << "occupied is dark";
  EXPECT_EQ(byte(5, 3), 255);

  const ColorImage half = picture.colors(Layer::kGrid, 2);
  EXPECT_EQ(half.columns, 2);
  EXPECT_EQ(half.rows, 1);
  EXPECT_DOUBLE_EQ(half.pixel_m, 0.1);
  EXPECT_EQ(static_cast<unsigned char>(half.rgba[4]), 32) << "occupied wins";
}

}  // namespace
}  // namespace topogeo::web
