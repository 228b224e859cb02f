#include "foxglove/foxglove_topics.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

/// Such messages have megabytes each: not one for every stop of a mapping robot.
constexpr double kGridPeriod_s = 1.5;

constexpr std::string_view kScene = "foxglove.SceneUpdate";
constexpr std::array<FoxgloveTopic, kFoxgloveTopics> kTopics = {{
    {1, "/tf", "foxglove.FrameTransforms", LiveTopic::kTransforms, {}, 0.0},
    {2, "/pose", "foxglove.PoseInFrame", LiveTopic::kPose, {}, 0.0},
    {3, "/scan", "foxglove.PointCloud", LiveTopic::kScan, {}, 0.0},
    {4, "/map", "foxglove.Grid", LiveTopic::kMap, {}, kGridPeriod_s},
    {5, "/map/rooms", "foxglove.Grid", LiveTopic::kRoomMap, {}, kGridPeriod_s},
    {6, "/graph", kScene, {}, Channel::kGraph, 0.0},
    {7, "/rooms", kScene, {}, Channel::kRooms, 0.0},
    {8, "/places", kScene, {}, Channel::kPlaces, 0.0},
    {9, "/rules", kScene, {}, Channel::kRules, 0.0},
    {10, "/route", kScene, {}, Channel::kRoute, 0.0},
    {11, "/log", "foxglove.Log", {}, Channel::kEvents, 0.0},
}};

// Schemas of JSON values and of messages.
namespace shape {

using Members = std::vector<std::pair<std::string, Json>>;

Json object(const Members& members, const std::string& title = {}) {
  Json properties = Json::object();
  for (const auto& [name, schema] : members) properties[name] = schema;
  Json json = Json::object();
  if (!title.empty()) json["title"] = title;
  json["type"] = "object";
  json["properties"] = std::move(properties);
  return json;
}

Json list_of(Json items) {
  return {{"type", "array"}, {"items", std::move(items)}};
}

Json number() {
  return {{"type", "number"}};
}

Json integer() {
  return {{"type", "integer"}, {"minimum", 0}};
}

Json text() {
  return {{"type", "string"}};
}

Json truth() {
  return {{"type", "boolean"}};
}

Json bytes() {
  return {{"type", "string"}, {"contentEncoding", "base64"}};
}

/// `values` in the order of their numbers, from `first`.
Json enumeration(const std::vector<std::string>& values, int first = 0) {
  Json choices = Json::array();
  for (const std::string& value : values) {
    choices.push_back({{"title", value}, {"const", first++}});
  }
  return {{"oneOf", std::move(choices)}};
}

Json instant(const std::string& title) {
  constexpr int kLastNanosecond = 999'999'999;
  return object({{"sec", {{"type", "integer"}}},
                 {"nsec", {{"type", "integer"}, {"minimum", 0}, {"maximum", kLastNanosecond}}}},
                title);
}

Json time() {
  return instant("time");
}

Json vector3() {
  return object({{"x", number()}, {"y", number()}, {"z", number()}});
}

Json quaternion() {
  return object({{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}});
}

Json pose() {
  return object({{"position", vector3()}, {"orientation", quaternion()}});
}

Json color() {
  return object({{"r", number()}, {"g", number()}, {"b", number()}, {"a", number()}});
}

/// Fields of packed cells and points: position of a number among their bytes.
Json packed_fields() {
  return list_of(object({{"name", text()},
                         {"offset", integer()},
                         {"type", enumeration({"UNKNOWN", "UINT8", "INT8", "UINT16", "INT16",
                                               "UINT32", "INT32", "FLOAT32", "FLOAT64"})}}));
}

Json transforms() {
  const Json one = object({{"timestamp", time()},
                           {"parent_frame_id", text()},
                           {"child_frame_id", text()},
                           {"translation", vector3()},
                           {"rotation", quaternion()}});
  return object({{"transforms", list_of(one)}});
}

Json pose_in_frame() {
  return object({{"timestamp", time()}, {"frame_id", text()}, {"pose", pose()}});
}

Json point_cloud() {
  return object({{"timestamp", time()},
                 {"frame_id", text()},
                 {"pose", pose()},
                 {"point_stride", integer()},
                 {"fields", packed_fields()},
                 {"data", bytes()}});
}

Json grid() {
  return object({{"timestamp", time()},
                 {"frame_id", text()},
                 {"pose", pose()},
                 {"column_count", integer()},
                 {"cell_size", object({{"x", number()}, {"y", number()}})},
                 {"row_stride", integer()},
                 {"cell_stride", integer()},
                 {"fields", packed_fields()},
                 {"data", bytes()}});
}

Json log() {
  return object({{"timestamp", time()},
                 {"level", enumeration({"UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"})},
                 {"message", text()},
                 {"name", text()},
                 {"file", text()},
                 {"line", integer()}});
}

Json spheres() {
  return list_of(object({{"pose", pose()}, {"size", vector3()}, {"color", color()}}));
}

Json lines() {
  return list_of(object({{"type", enumeration({"LINE_STRIP", "LINE_LOOP", "LINE_LIST"})},
                         {"pose", pose()},
                         {"thickness", number()},
                         {"scale_invariant", truth()},
                         {"points", list_of(vector3())},
                         {"color", color()},
                         {"colors", list_of(color())},
                         {"indices", list_of(integer())}}));
}

Json texts() {
  return list_of(object({{"pose", pose()},
                         {"billboard", truth()},
                         {"font_size", number()},
                         {"scale_invariant", truth()},
                         {"color", color()},
                         {"text", text()}}));
}

// Primitives that no topic uses are left out, because their lists would always be empty.
Json scene_update() {
  const Json deletion = object(
      {{"timestamp", time()}, {"type", enumeration({"MATCHING_ID", "ALL"})}, {"id", text()}});
  const Json entity = object({{"timestamp", time()},
                              {"frame_id", text()},
                              {"id", text()},
                              {"lifetime", instant("duration")},
                              {"frame_locked", truth()},
                              {"spheres", spheres()},
                              {"lines", lines()},
                              {"texts", texts()}});
  return object({{"deletions", list_of(deletion)}, {"entities", list_of(entity)}});
}

}  // namespace shape

}  // namespace

const std::array<FoxgloveTopic, kFoxgloveTopics>& foxglove_topics() {
  return kTopics;
}

const FoxgloveTopic* foxglove_topic(std::uint64_t channel_id) {
  const auto found = std::ranges::find_if(
      kTopics, [&](const FoxgloveTopic& topic) { return topic.channel_id == channel_id; });
  return found == kTopics.end() ? nullptr : &*found;
}

std::string foxglove_schema(std::string_view type) {
  static const std::map<std::string_view, Json (*)()> kTypes = {
      {"foxglove.FrameTransforms", shape::transforms},
      {"foxglove.PoseInFrame", shape::pose_in_frame},
      {"foxglove.PointCloud", shape::point_cloud},
      {"foxglove.Grid", shape::grid},
      {"foxglove.Log", shape::log},
      {kScene, shape::scene_update}};
  Json schema = kTypes.at(type)();
  schema["title"] = type;
  return text_of(schema);
}

std::string advertisement() {
  Json channels = Json::array();
  for (const FoxgloveTopic& topic : kTopics) {
    channels.push_back({{"id", topic.channel_id},
                        {"topic", topic.name},
                        {"encoding", "json"},
                        {"schemaName", topic.schema},
                        {"schema", foxglove_schema(topic.schema)},
                        {"schemaEncoding", "jsonschema"}});
  }
  return text_of(Json{{"op", "advertise"}, {"channels", std::move(channels)}});
}

}  // namespace topogeo::web
