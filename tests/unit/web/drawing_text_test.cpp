// Drawings in the page's format, in both directions.
#include "orders/drawing_text.hpp"

#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>

namespace topogeo::web {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const std::string kAll = R"({"version":"7",
  "places":[{"name":"kitchen","x_m":1,"y_m":-2.5},
            {"name":"base station","x_m":0.1,"y_m":0,"heading_rad":1.5}],
  "zones":[{"name":"hall","kind":"room","value":0,"corners_m":[0,0,4,0,4,3]},
           {"name":"ramp","kind":"slow","value":0.3,"corners_m":[0,0,1,0,1,1]}],
  "walls":[{"points_m":[0,0,1,0,1,2]}],
  "openings":[{"points_m":[0.25,0,0.75,0]}],
  "doors":[{"name":"front door","points_m":[1,0,1,1]}]})";

TEST(DrawingText, ComesBackAsItWas) {
  const storage::MapDrawing drawing = parse_drawing(kAll);
  EXPECT_EQ(drawing.version, 7U);
  ASSERT_EQ(drawing.places.size(), 2U);
  EXPECT_EQ(drawing.places[1].station_heading_rad, 1.5);
  ASSERT_EQ(drawing.zones.size(), 2U);
  EXPECT_EQ(drawing.zones[1].kind, planning::ZoneKind::kSlow);
  EXPECT_EQ(drawing.zones[1].value, 0.3);
  ASSERT_EQ(drawing.lines.size(), 3U);
  EXPECT_EQ(drawing.lines[0].points_m.size(), 3U);
  EXPECT_EQ(drawing.lines[1].kind, planning::LineKind::kOpening);
  EXPECT_EQ(drawing.lines[2].name, "front door");
  EXPECT_EQ(Json::parse(text_of(json_of(drawing))), Json::parse(kAll));
}

TEST(DrawingText, WhatIsWrongIsNamed) {
  const auto error_of_entry = [](const std::string& list, const std::string& entry) {
    const std::string body = R"({"version":"1",")" + list + R"(":[)" + entry + "]}";
    try {
      static_cast<void>(parse_drawing(body));
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("nothing is wrong");
  };
  const std::string good = R"({"name":"a","kind":"no_go","corners_m":[0,0,1,0,1,1]},)";
  EXPECT_THAT(error_of_entry("zones", good + R"({"name":"b","kind":"lava"})"),
              HasSubstr("zones[1] 'b': kind"));
  EXPECT_THAT(error_of_entry("zones", good + R"({"name":"b","kind":"no_go","corners_m":[0,0,1]})"),
              HasSubstr("zones[1] 'b': corners_m"));
  EXPECT_THAT(
      error_of_entry("zones", good + R"({"name":"b","kind":"no_go","corners_m":[0,0,1,0]})"),
      HasSubstr("zones[1]: zone 'b': 2 corners"));
  EXPECT_THAT(
      error_of_entry("zones",
                     good + R"({"name":"b","kind":"slow","value":0,"corners_m":[0,0,1,0,1,1]})"),
      HasSubstr("zones[1]: zone 'b': 0 m/s"));
  EXPECT_THAT(
      error_of_entry("zones", good + R"({"name":"a","kind":"no_go","corners_m":[0,0,1,0,1,1]})"),
      HasSubstr("zones[1]: zone 'a': the name is taken"));
  EXPECT_THAT(error_of_entry("zones", R"({"name":"a","kind":"no_go","corners_m":[0,0,1,"x"]})"),
              HasSubstr("expected numbers"));
  EXPECT_THAT(error_of_entry("places", R"({"name":"p","x_m":1})"), HasSubstr("places[0] 'p': y_m"));
  EXPECT_THAT(error_of_entry("places", R"({"x_m":1,"y_m":1})"), HasSubstr("places[0]"));
  EXPECT_THAT(error_of_entry("places", "7"), HasSubstr("places[0]: expected an object"));
  EXPECT_THAT(error_of_entry("walls", R"({"points_m":[0,0]})"), HasSubstr("walls[0]"));
  EXPECT_THAT(error_of_entry("openings", R"({"points_m":[0,0,1,0,2,0]})"),
              HasSubstr("openings[0]"));
  EXPECT_THAT(error_of_entry("doors", R"({"points_m":[0,0,1,0]})"), HasSubstr("doors[0]"));
  EXPECT_THAT([] { parse_drawing(R"({"places":[]})"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("version")));
  EXPECT_THAT([] { parse_drawing(R"({"version":7})"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("version")));
  EXPECT_THAT([] { parse_drawing(R"({"version":"7","zones":{}})"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("zones: expected a list")));
  EXPECT_THROW(parse_drawing("garbage"), std::invalid_argument);
}

TEST(DrawingText, HasNoMoreThanMapsHaveRoomFor) {
  Json walls = Json::array();
  for (int i = 0; i < 257; ++i) walls.push_back({{"points_m", {0, 0, 1, i}}});
  EXPECT_THAT(
      [&] {
        parse_drawing(text_of(Json{{"version", "0"}, {"walls", walls}}));
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("257 zones")));
  const auto floor_of = [&walls] {
    return parse_floor(text_of(
        Json{{"target", "robot"}, {"start", {{"x_m", 0.5}, {"y_m", 0.5}}}, {"walls", walls}}));
  };
  while (walls.size() < 4096) walls.push_back({{"points_m", {0, 0, 1, walls.size()}}});
  EXPECT_EQ(floor_of().drawing.lines.size(), 4096U);
  walls.push_back({{"points_m", {0, 0, 1, 1}}});
  EXPECT_THAT(floor_of, ThrowsMessage<std::invalid_argument>(HasSubstr("4097 walls")));
  Json points = Json::array();
  for (int i = 0; i < 514; ++i) points.push_back(i);
  EXPECT_THAT(
      [&] {
        parse_drawing(text_of(Json{{"version", "0"}, {"walls", {{{"points_m", points}}}}}));
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("walls[0]: 257 points")));
}

TEST(DrawingText, ShapesAreOfZones) {
  const ShapesOrder order = parse_shapes_order(R"({"zones":[3,4],"cut_m":[0,0,1,1]})");
  EXPECT_THAT(order.zones, testing::ElementsAre(3, 4));
  EXPECT_EQ(order.cut_m->second, Eigen::Vector2d(1.0, 1.0));
  EXPECT_FALSE(parse_shapes_order(R"({"zones":[3]})").cut_m);
  for (const char* body : {R"({})", R"({"zones":[]})", R"({"zones":[-1]})", R"({"zones":["a"]})",
                           R"({"zones":[65535]})", R"({"zones":[1],"cut_m":[0,0,0,0]})",
                           R"({"zones":[1],"cut_m":[0,0]})", R"({"zones":[1],"cut_m":7})"}) {
    EXPECT_THROW(parse_shapes_order(body), std::invalid_argument) << body;
  }
}

TEST(DrawingText, AFloorHasAStartAndAWall) {
  const std::string walls = R"("walls":[{"points_m":[0,0,1,0,1,2]}])";
  const FloorText floor =
      parse_floor(R"({"target":"simulator","name":"new","start":{"x_m":1,"y_m":2},)" + walls + "}");
  EXPECT_TRUE(floor.simulator);
  EXPECT_EQ(floor.name, "new");
  EXPECT_EQ(floor.T_floor_start, (geometry::Pose2{1.0, 2.0, 0.0}));
  EXPECT_EQ(floor.drawing.lines.size(), 1U);
  EXPECT_FALSE(
      parse_floor(R"({"target":"robot","start":{"x_m":1,"y_m":2,"heading_rad":1},)" + walls + "}")
          .simulator);
  const auto refusal = [](const std::string& body) { return [body] { parse_floor(body); }; };
  EXPECT_THAT(refusal(R"({"target":"moon"})"),
              ThrowsMessage<std::invalid_argument>(HasSubstr("target")));
  EXPECT_THAT(refusal(R"({"target":"robot",)" + walls + "}"),
              ThrowsMessage<std::invalid_argument>(HasSubstr("start")));
  EXPECT_THAT(refusal(R"({"target":"robot","start":{"x_m":1,"y_m":2}})"),
              ThrowsMessage<std::invalid_argument>(HasSubstr("walls")));
}

}  // namespace
}  // namespace topogeo::web
