#include "foxglove/foxglove_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "foxglove/foxglove_json.hpp"

namespace topogeo::web {
namespace {

// Heights of objects on the floor, over the grid: a few centimetres apart to avoid flicker.
constexpr double kRuleHeight_m = 0.02;
constexpr double kGraphHeight_m = 0.04;
constexpr double kRouteHeight_m = 0.06;
constexpr double kTextHeight_m = 0.3;

constexpr double kNodeSize_m = 0.16;
constexpr double kPlaceSize_m = 0.24;
constexpr double kBranchWidth_m = 0.03;
constexpr double kRuleWidth_m = 0.05;
constexpr double kRouteWidth_m = 0.08;
constexpr double kLetters_m = 0.4;

constexpr int kLineStrip = 0;
constexpr int kLineLoop = 1;
constexpr int kDeleteOne = 0;
constexpr int kDeleteAll = 1;

/// Components from 0 to 1.
struct SceneColor {
  double red = 0.0;
  double green = 0.0;
  double blue = 0.0;
};
constexpr SceneColor kGrey{0.6, 0.6, 0.6};
constexpr SceneColor kBlue{0.2, 0.5, 0.9};
constexpr SceneColor kGreen{0.2, 0.7, 0.3};
constexpr SceneColor kOrange{0.95, 0.6, 0.15};
constexpr SceneColor kRed{0.85, 0.2, 0.2};
constexpr SceneColor kPurple{0.6, 0.35, 0.8};

Json color_json(const SceneColor& color) {
  return {{"r", color.red}, {"g", color.green}, {"b", color.blue}, {"a", 1.0}};
}

SceneColor color_of_node(const std::string& kind) {
  static const std::map<std::string, SceneColor> kColors = {
      {"real", kBlue},   {"fictitious", kGrey},  {"virtual", kPurple},
      {"door", kOrange}, {"narrowing", kOrange}, {"hall_corridor", kGreen}};
  const auto found = kColors.find(kind);
  return found == kColors.end() ? kGrey : found->second;
}

SceneColor color_of_rule(const std::string& kind) {
  if (kind == "no_go") return kRed;
  if (kind == "preferred") return kGreen;
  return kind == "slow" ? kOrange : kPurple;
}

Json line_json(const Json& coordinates_m, double height_m, double width_m, int type,
               const SceneColor& color) {
  Json points = Json::array();
  for (std::size_t i = 0; i + 1 < coordinates_m.size(); i += 2) {
    points.push_back(foxglove_vector(coordinates_m[i], coordinates_m[i + 1], height_m));
  }
  return {{"type", type},
          {"pose", foxglove_pose(0.0, 0.0)},
          {"thickness", width_m},
          {"scale_invariant", false},
          {"points", std::move(points)},
          {"color", color_json(color)},
          {"colors", Json::array()},
          {"indices", Json::array()}};
}

Json sphere_json(double x_m, double y_m, double size_m, const SceneColor& color) {
  return {{"pose", foxglove_pose(x_m, y_m, 0.0, kGraphHeight_m)},
          {"size", foxglove_vector(size_m, size_m, size_m)},
          {"color", color_json(color)}};
}

Json text_json(double x_m, double y_m, const std::string& text, const SceneColor& color) {
  return {{"pose", foxglove_pose(x_m, y_m, 0.0, kTextHeight_m)},
          {"billboard", true},
          {"font_size", kLetters_m},
          {"scale_invariant", false},
          {"color", color_json(color)},
          {"text", text}};
}

/// An entity without primitives.
Json empty_entity(const std::string& id, std::int64_t now_ns) {
  return {{"timestamp", foxglove_time(now_ns)},
          {"frame_id", kMapFrame},
          {"id", id},
          {"lifetime", foxglove_time(0)},
          {"frame_locked", true},
          {"spheres", Json::array()},
          {"lines", Json::array()},
          {"texts", Json::array()}};
}

void draw_graph(const Json& object, Json& entity) {
  if (object.contains("points_m")) {
    entity["lines"].push_back(line_json(object.at("points_m"), kGraphHeight_m, kBranchWidth_m,
                                        kLineStrip,
                                        object.value("virtual", false) ? kPurple : kBlue));
  } else if (object.contains("kind")) {  // the summary of the map has no kind
    entity["spheres"].push_back(sphere_json(object.at("x_m"), object.at("y_m"), kNodeSize_m,
                                            color_of_node(object.at("kind"))));
  }
}

void draw_room(const Json& object, Json& entity) {
  entity["texts"].push_back(
      text_json(object.at("x_m"), object.at("y_m"), object.at("name"), kGreen));
}

void draw_place(const std::string& name, const Json& object, Json& entity) {
  entity["spheres"].push_back(
      sphere_json(object.at("x_m"), object.at("y_m"), kPlaceSize_m, kOrange));
  entity["texts"].push_back(text_json(object.at("x_m"), object.at("y_m"), name, kOrange));
}

void draw_rule(const std::string& name, const Json& object, Json& entity) {
  const Json& corners_m = object.at("corners_m");
  const SceneColor color = color_of_rule(object.at("kind"));
  entity["lines"].push_back(line_json(corners_m, kRuleHeight_m, kRuleWidth_m, kLineLoop, color));
  if (corners_m.size() >= 2) {
    entity["texts"].push_back(text_json(corners_m[0], corners_m[1], name, color));
  }
}

void draw_route(const Json& route, Json& entity) {
  if (route.is_null() || !route.value("found", false)) return;
  entity["lines"].push_back(
      line_json(route.at("points_m"), kRouteHeight_m, kRouteWidth_m, kLineStrip, kGreen));
}

void draw(Channel channel, const std::string& key, const Json& object, Json& entity) {
  switch (channel) {
    case Channel::kGraph:
      return draw_graph(object, entity);
    case Channel::kRooms:
      return draw_room(object, entity);
    case Channel::kPlaces:
      return draw_place(key, object, entity);
    case Channel::kRules:
      return draw_rule(key, object, entity);
    case Channel::kRoute:
      return draw_route(object, entity);
    default:
      throw std::invalid_argument("no topic shows channel " + std::string(name_of(channel)));
  }
}

bool is_visible(const Json& entity) {
  return !entity["spheres"].empty() || !entity["lines"].empty() || !entity["texts"].empty();
}

Json deletion(int type, const std::string& id, std::int64_t now_ns) {
  return {{"timestamp", foxglove_time(now_ns)}, {"type", type}, {"id", id}};
}

std::string scene_update(Channel channel, const Json& update, std::int64_t now_ns) {
  Json deletions = Json::array();
  Json entities = Json::array();
  const auto add = [&](const std::string& key, const Json& object) {
    Json entity = empty_entity(key, now_ns);
    try {
      draw(channel, key, object, entity);
    } catch (const Json::exception&) {  // an unknown number
      return;
    }
    if (is_visible(entity)) entities.push_back(std::move(entity));
  };
  if (is_table(channel)) {
    if (update.at("from") == 0) deletions.push_back(deletion(kDeleteAll, "", now_ns));
    for (const auto& [key, object] : update.at("set").items()) add(key, object);
    for (const Json& key : update.at("gone"))
      deletions.push_back(deletion(kDeleteOne, key, now_ns));
  } else {
    deletions.push_back(deletion(kDeleteAll, "", now_ns));
    add(std::string(name_of(channel)), update.at("value"));
  }
  return text_of(Json{{"deletions", std::move(deletions)}, {"entities", std::move(entities)}});
}

int log_level(const std::string& level) {
  constexpr int kLogInfo = 2;
  constexpr int kLogWarning = 3;
  constexpr int kLogError = 4;
  if (level == "error") return kLogError;
  return level == "warning" ? kLogWarning : kLogInfo;
}

std::vector<std::string> log_messages(const Json& update) {
  std::map<std::uint64_t, const Json*> events;  // keys of the table are numbers
  for (const auto& [key, event] : update.at("set").items())
    events.emplace(std::stoull(key), &event);
  std::vector<std::string> messages;
  messages.reserve(events.size());
  for (const auto& [number, event] : events) {
    const auto stamp_ns =
        static_cast<std::int64_t>(std::llround(event->at("time_s").get<double>() * 1e9));
    messages.push_back(text_of(Json{{"timestamp", foxglove_time(stamp_ns)},
                                    {"level", log_level(event->at("level"))},
                                    {"message", event->at("text")},
                                    {"name", event->at("source")},
                                    {"file", ""},
                                    {"line", 0}}));
  }
  return messages;
}

}  // namespace

std::vector<std::string> foxglove_messages(Channel channel, std::string_view update,
                                           std::int64_t now_ns) {
  const Json json = Json::parse(update);
  if (channel == Channel::kEvents) return log_messages(json);
  return {scene_update(channel, json, now_ns)};
}

}  // namespace topogeo::web
