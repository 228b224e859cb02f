#include "topogeo/exchange/geojson.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "readers.hpp"
#include "sample_floor.hpp"

namespace topogeo::exchange {
namespace {

using testing::Contains;
using testing::HasSubstr;

class Geojson : public ScratchTest {
 protected:
  static std::string sample_text() {
    const planning::FreeSpace space = sample_space();
    const storage::MapDrawing drawing = sample_drawing();
    const topomap::GlobalMap map = sample_graph();
    return geojson_text(map, drawing, route_network(map, drawing, &space, {}));
  }
};

TEST_F(Geojson, ReadsBackToTheLastDigit) {
  const MapGraph graph = parse_geojson(sample_text(), "f");
  expect_same(graph.map, sample_graph());
  expect_same_places(graph.drawing, sample_drawing());
  expect_same_zones(graph.drawing, sample_drawing());
}

TEST_F(Geojson, IsTheSameTextAgain) {
  EXPECT_EQ(sample_text(), sample_text());
}

TEST_F(Geojson, IsReadByTheRulesOfNav2) {
  const RouteNetwork network = route_network(sample_graph(), sample_drawing(), nullptr, {});
  std::size_t edges = 0;
  for (const NetworkPiece& piece : network.pieces) {
    edges += piece.rule.forward;
    edges += piece.rule.backward;
  }
  EXPECT_EQ(edges, 2 * network.pieces.size() - 2);  // the lane
  EXPECT_EQ(run_reader({"geojson", write("map.geojson", sample_text())}),
            std::to_string(network.nodes.size()) + " " + std::to_string(edges) + "\n");
  EXPECT_THAT(sample_text(), HasSubstr("\"abs_speed_limit\":0.35"));
}

TEST_F(Geojson, TheReaderOfTheTestsRefusesWhatNav2Does) {
  // A good file with one change each; without this test the reader would prove nothing.
  const auto broken = [&](const std::string& what, const std::string& by) {
    std::string text = sample_text();
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    text.replace(at, what.size(), by);
    return error_of([&] { run_reader({"geojson", write("bad.geojson", text)}); });
  };
  EXPECT_THAT(broken("\"clearance\":0.9", "\"clearance\":null"), HasSubstr("null"));
  EXPECT_THAT(broken("\"id\":200000", "\"id\":2"), HasSubstr("twice"));
  EXPECT_THAT(broken("\"startid\":2,", "\"startid\":77,"), HasSubstr("unknown end"));
}

TEST_F(Geojson, ForeignGraphsBecomeStraightBranches) {
  const MapGraph graph = parse_geojson(R"({"type":"FeatureCollection","features":[
{"type":"Feature","properties":{"id":0,"frame":"map"},"geometry":{"type":"Point","coordinates":[1.5,-2.0]}},
{"type":"Feature","properties":{"id":3,"metadata":{"name":"dock"}},"geometry":{"type":"Point","coordinates":[4,0.5]}},
{"type":"Feature","properties":{"id":10,"startid":0,"endid":3},"geometry":{"type":"MultiLineString","coordinates":[]}},
{"type":"Feature","properties":{"id":11,"startid":3,"endid":0},"geometry":{"type":"LineString"}},
{"type":"Feature","properties":{"name":"lawn"},"geometry":{"type":"Polygon","coordinates":[[[0,0],[1,0],[1,1],[0,0]]]}},
{"type":"Feature","properties":{},"geometry":{"type":"MultiPoint","coordinates":[]}}]})",
                                       "f");
  ASSERT_EQ(graph.map.nodes.size(), 2U);
  EXPECT_EQ(graph.map.nodes[1].id, 3U);
  ASSERT_EQ(graph.map.branches.size(), 1U);
  EXPECT_EQ(graph.map.branches[0].points[1].position_m, Eigen::Vector2d(4.0, 0.5));
  ASSERT_EQ(graph.drawing.places.size(), 1U);
  EXPECT_EQ(graph.drawing.places[0].name, "dock");
  ASSERT_EQ(graph.drawing.zones.size(), 1U);
  EXPECT_EQ(graph.drawing.zones[0].polygon_m.size(), 3U);
  EXPECT_THAT(graph.notes, Contains(HasSubstr("MultiPoint left out")));
}

std::string point(const std::string& properties, const std::string& position) {
  return R"({"type":"Feature","properties":)" + properties +
         R"(,"geometry":{"type":"Point","coordinates":)" + position + "}}";
}
std::string polygon(const std::string& properties, const std::string& ring) {
  return R"({"type":"Feature","properties":)" + properties +
         R"(,"geometry":{"type":"Polygon","coordinates":[)" + ring + "]}}";
}
MapGraph features(const std::string& list, const std::string& before = "") {
  return parse_geojson("{" + before + R"("type":"FeatureCollection","features":[)" + list + "]}",
                       "f");
}
constexpr const char* kTriangle = "[[0,0],[1,0],[1,1],[0,0]]";

TEST_F(Geojson, ReadsWhatTablesWrite) {
  // A table of nodes and edges has numbers with a point, and null where a column does not apply.
  const MapGraph graph = features(
      point(R"({"id":1.0,"startid":null,"endid":null})", "[0,0]") + "," +
      point(R"({"id":2.0,"startid":null,"endid":null})", "[5,0]") + "," +
      R"({"type":"Feature","properties":{"id":7.0,"startid":1.0,"endid":2.0},"geometry":{"type":"LineString","coordinates":[[0,0],[5,0]]}},)" +
      polygon("null", kTriangle) + R"(,{"type":"Feature","properties":null,"geometry":null})");
  EXPECT_EQ(graph.map.branches.size(), 1U);
  EXPECT_EQ(graph.drawing.zones.size(), 1U);
  EXPECT_THAT(graph.notes, Contains(HasSubstr("features[4]: left out, it has no geometry")));
}

TEST_F(Geojson, ARepeatedNameGetsANumber) {
  const MapGraph graph = features(point(R"({"id":1,"metadata":{"name":"dock"}})", "[0,0]") + "," +
                                  point(R"({"id":2,"metadata":{"name":"dock"}})", "[5,0]") + "," +
                                  polygon(R"({"name":"lawn"})", kTriangle) + "," +
                                  polygon(R"({"name":"lawn"})", kTriangle));
  ASSERT_EQ(graph.drawing.places.size(), 2U);
  EXPECT_EQ(graph.drawing.places[1].name, "dock 2");
  EXPECT_EQ(graph.drawing.zones[1].name, "lawn 2");
  EXPECT_THAT(graph.notes, Contains("a second 'dock' is named 'dock 2'"));
}

TEST_F(Geojson, RepeatedNamesSkipNumbersThatTheFileHas) {
  std::string list = polygon(R"({"name":"lawn 3"})", kTriangle);
  for (int i = 0; i < 4096; ++i) list += "," + polygon(R"({"name":"lawn"})", kTriangle);
  EXPECT_THROW(features(list), std::runtime_error);  // a zone more than a map may have
  list.erase(list.rfind(",{\"type\":\"Feature\""));
  const std::vector<planning::DrawnZone> zones = features(list).drawing.zones;
  ASSERT_EQ(zones.size(), 4096U);
  EXPECT_EQ(zones[2].name, "lawn 2");
  EXPECT_EQ(zones[3].name, "lawn 4");
  EXPECT_EQ(zones.back().name, "lawn 4096");
}

TEST_F(Geojson, DegreesBecomeMetres) {
  const std::string nodes =
      point(R"({"id":1})", "[8.41,49.01]") + "," + point(R"({"id":2})", "[8.4105,49.01]") + "," +
      point(R"({"id":3})", "[8.4105,49.0104]") +
      R"(,{"type":"Feature","properties":{"id":9,"startid":1,"endid":2},"geometry":{"type":"LineString","coordinates":[[0,0],[1,1]]}})";
  for (const char* system :
       {"", R"("crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:OGC:1.3:CRS84"}},)"}) {
    const MapGraph graph = features(nodes, system);
    ASSERT_EQ(graph.map.nodes.size(), 3U);
    const Eigen::Vector2d east_m = graph.map.nodes[1].position_m - graph.map.nodes[0].position_m;
    const Eigen::Vector2d north_m = graph.map.nodes[2].position_m - graph.map.nodes[1].position_m;
    // A degree of longitude and of latitude on WGS84 at latitude 49.01, by its radii of curvature.
    EXPECT_NEAR(east_m.x(), 0.0005 * 73157.14, 0.01);
    EXPECT_NEAR(north_m.y(), 0.0004 * 111209.93, 0.01);
    EXPECT_NEAR(east_m.y(), 0.0, 0.01);
    EXPECT_THAT(graph.notes, Contains(HasSubstr("degrees of WGS84")));
  }
  // The same numbers are metres where the file says so.
  const MapGraph metres = features(
      nodes, R"("crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::3857"}},)");
  EXPECT_EQ(metres.map.nodes[0].position_m, Eigen::Vector2d(8.41, 49.01));
}

TEST_F(Geojson, AFarOriginIsMovedToTheMap) {
  const MapGraph graph = features(point(R"({"id":1})", "[466123.5,5428765.0]") + "," +
                                  point(R"({"id":2})", "[466128.5,5428769.0]"));
  EXPECT_EQ(graph.map.nodes[0].position_m, Eigen::Vector2d(-2.5, -2.0));
  EXPECT_EQ(graph.map.nodes[1].position_m, Eigen::Vector2d(2.5, 2.0));
  EXPECT_THAT(graph.notes, Contains(HasSubstr("x = 466126, y = 5428767 m of the file")));
}

TEST_F(Geojson, ZonesThatCannotBeAreRefused) {
  const auto error = [](const std::string& properties, const std::string& ring) {
    return error_of([&] { static_cast<void>(features(polygon(properties, ring))); });
  };
  EXPECT_THAT(error(R"({"name":"p","kind":"no_go"})", "[[0,0],[2,2],[2,0],[0,2],[0,0]]"),
              HasSubstr("f: zone 'p': expected a border that neither crosses nor touches itself"));
  EXPECT_THAT(error(R"({"name":"p","kind":"slow","value":0})", kTriangle),
              HasSubstr("zone 'p': expected a speed of 0.01 to 10 m/s, got 0"));
  EXPECT_THAT(error(R"({"name":"p","kind":"one_way","value":90})", kTriangle),
              HasSubstr("zone 'p': expected a direction of -pi to pi rad, got 90"));
}

TEST_F(Geojson, NamesWhatIsWrong) {
  const auto error = [](const std::string& text) {
    return error_of([&] { parse_geojson(text, "f.geojson"); });
  };
  EXPECT_EQ(error("{"), "f.geojson: expected JSON, invalid at byte 2");
  EXPECT_EQ(error("{}"), "f.geojson: features: expected a value, got nothing");
  EXPECT_EQ(error(R"({"features":[]})"), "f.geojson: features: expected a feature, got []");
  EXPECT_EQ(
      error(
          R"({"features":[{"geometry":{"type":"Point","coordinates":[0,0]},"properties":{"id":-1}}]})"),
      "f.geojson: features[0].properties.id: expected a whole number from 0 to 4294967295, "
      "got -1");
  EXPECT_EQ(
      error(
          R"({"features":[{"geometry":{"type":"Point","coordinates":[0,"x"]},"properties":{"id":1}}]})"),
      "f.geojson: features[0].geometry.coordinates[1]: expected a number, got \"x\"");
  EXPECT_EQ(
      error(
          R"({"features":[{"geometry":{"type":"LineString"},"properties":{"id":1,"startid":5,"endid":6}}]})"),
      "f.geojson: branch 1 ends at node 5, which does not exist");
}

TEST_F(Geojson, NodesWithLargeIdsGetOthersInTheFileAlone) {
  topomap::GlobalMap map = sample_graph();
  // Ids of virtual nodes are this large.
  map.nodes.back().id = 2'147'483'650U;
  for (topomap::MapBranch& branch : map.branches) {
    if (branch.node_b == 12) branch.node_b = map.nodes.back().id;
  }
  const std::string text = geojson_text(map, {}, route_network(map, {}, nullptr, {}));
  EXPECT_THAT(text, HasSubstr("\"id\":100000,"));
  EXPECT_THAT(text, testing::Not(HasSubstr("\"startid\":2147483650")));
  run_reader({"geojson", write("large.geojson", text)});
  expect_same(parse_geojson(text, "f").map, map);
}

}  // namespace
}  // namespace topogeo::exchange
